"""Studies packed for a repository, read again as repositories and others read them."""

import csv
import json
import re
from pathlib import Path

import pytest
from rocrate.rocrate import ROCrate

from stimuli.errors import InputError
from study.cli import main
from study.protocol.protocol import shipped
from study.record.contents import contents_of
from study.record.crate import LICENCES, pack_crate
from study.record.dataset import enrol
from study.record.psychds import pack_psych_ds
from study.session.simulation import simulate
from study.trials.reading import parse_protocol
from tests.study.record.test_bids import LAB

# From the schema of Psych-DS: how tables are called, which keywords are its own.
TABLE_NAME = re.compile(r"([a-z]+-[a-zA-Z0-9]+)(_[a-z]+-[a-zA-Z0-9]+)*_data\.csv")
OFFICIAL = {"study", "site", "subject", "session", "task", "condition", "trial", "stimulus",
            "description"}  # fmt: skip


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("export") / "data"
    for name in ("jnd-center", "weights"):
        text = shipped()[name].read_text(encoding="utf-8") + LAB
        simulate(parse_protocol(text), {"locomotion": 10, "dance": 10}, 2, 5, folder, workers=1)
    enrol(folder, "sim001", comments='slow, but "fine"')
    source = folder / "sourcedata/sub-sim001/beh"
    source.mkdir(parents=True)
    (source / "sub-sim001_task-weights_run-1_flips.tsv").write_text("trial\tframe\n")
    (source / "weights.lock").touch()
    (folder / "derivatives/segue").mkdir(parents=True)
    (folder / "derivatives/segue/report.html").write_text("<p>")
    return folder


def test_psych_ds_asks_for_nothing_that_is_not_there(data: Path, tmp_path: Path) -> None:
    """Its rules that are errors, and those of names: the validator is no public package."""
    out = tmp_path / "out"
    pack_psych_ds(data, out)
    document = json.loads((out / "dataset_description.json").read_text())
    assert document["@context"] == "https://schema.org/"
    assert document["@type"] == "Dataset"
    assert document["name"]
    assert [person["name"] for person in document["author"]] == [
        "A. Experimenter", "B. Experimenter",
    ]  # fmt: skip
    named = {column["name"]: column["description"] for column in document["variableMeasured"]}
    assert all(named.values())
    tables = [p for p in (out / "data").rglob("*.csv") if "raw" not in p.parts]
    assert len(tables) == 5
    used = set()
    for path in tables:
        assert TABLE_NAME.fullmatch(path.name)
        assert set(re.findall(r"([a-z]+)-", path.name)) <= OFFICIAL
        with path.open(encoding="utf-8", newline="") as stream:
            header, *rows = list(csv.reader(stream))
        assert rows
        assert {len(row) for row in rows} == {len(header)}
        assert len(set(header)) == len(header)
        used |= set(header)
    assert used == set(named)
    required = {"name", "description", "variableMeasured", "schemaVersion", "author", "license"}
    assert required <= {key for key, value in document.items() if value}
    assert all("@type" in held for key in ("author", "variableMeasured") for held in document[key])
    assert (out / ".psychdsignore").read_text() == "data/raw/\n"
    assert {path.name for path in out.iterdir()} - {".psychdsignore"} == {
        "data", "results", "materials", "README.md", "dataset_description.json",
    }  # fmt: skip
    assert (out / "results/segue/report.html").is_file()
    assert len(list((out / "materials/protocols").glob("*.json"))) == 2


def test_nothing_is_lost_on_the_way(data: Path, tmp_path: Path) -> None:
    pack_psych_ds(data, tmp_path / "out")
    raw = tmp_path / "out/data/raw"
    for place in contents_of(data).files:
        if not place.startswith("derivatives"):
            assert (raw / place).read_bytes() == (data / place).read_bytes()
    name = "data/subject-sim002/subject-sim002_task-jndcenter_session-1_data.csv"
    with (tmp_path / "out" / name).open(encoding="utf-8", newline="") as stream:
        packed = list(csv.DictReader(stream))
    table = data / "sub-sim002/beh/sub-sim002_task-jndcenter_run-1_beh.tsv"
    with table.open(encoding="utf-8", newline="") as stream:
        recorded = list(csv.DictReader(stream, delimiter="\t"))
    whose = {"participant": "sim002", "session": "1"}
    assert packed == [{**whose, **row} for row in recorded]
    people = (tmp_path / "out/data/description-participants_data.csv").read_text()
    assert list(csv.reader(people.splitlines()))[1][-1] == 'slow, but "fine"'


def test_a_crate_opens_again_with_every_file_described(data: Path, tmp_path: Path) -> None:
    pack_crate(data, tmp_path / "crate")
    crate = ROCrate(tmp_path / "crate")
    described = {entity.id: entity for entity in crate.data_entities}
    there = {p.relative_to(tmp_path / "crate").as_posix()
             for p in (tmp_path / "crate").rglob("*") if p.is_file()}  # fmt: skip
    assert set(described) == there - {"ro-crate-metadata.json"}
    assert set(described) == set(contents_of(data).files)
    for place, entity in described.items():
        assert entity["description"]
        assert int(entity["contentSize"]) == (data / place).stat().st_size
        assert (tmp_path / "crate" / place).read_bytes() == (data / place).read_bytes()
    assert {e["encodingFormat"] for e in described.values()} == {
        "text/tab-separated-values", "application/json", "text/markdown", "text/html",
    }  # fmt: skip
    root = crate.root_dataset
    assert root["license"].id == LICENCES["CC0"]
    assert [person["name"] for person in root["author"]] == ["A. Experimenter", "B. Experimenter"]
    assert "4 sessions of 2 people" in root["description"]
    assert {"response", "onset"} <= {column["name"] for column in root["variableMeasured"]}
    assert root["mentions"]["instrument"]


def test_what_people_would_be_known_by_is_said(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["export", str(data), "--ro-crate", str(tmp_path / "crate")]) == 0
    assert "comments of people are in it; `segue anonymise" in capsys.readouterr().err
    main(["anonymise", str(data), "--out", str(tmp_path / "shared")])
    capsys.readouterr()
    assert main(["export", str(tmp_path / "shared"), "--psych-ds", str(tmp_path / "out")]) == 0
    assert capsys.readouterr().err == ""
    assert main(["export", str(data)]) == 2
    assert "--psych-ds OUT or --ro-crate OUT" in capsys.readouterr().err


def test_a_place_that_is_taken_is_left_alone(data: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"--psych-ds .* not there yet"):
        pack_psych_ds(data, tmp_path)
    assert list(tmp_path.iterdir()) == []
