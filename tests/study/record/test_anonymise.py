"""Copies of data sets in which nobody is known, and which say the same."""

import csv
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stimuli.errors import InputError
from study.cli import main
from study.protocol.protocol import shipped
from study.record.anonymise import SIDECAR, TIMES, anonymise, new_names
from study.record.dataset import enrol
from study.record.people import QUESTIONS
from study.session.simulation import simulate
from study.trials.reading import parse_protocol
from tests.study.record.test_bids import LAB, UNKNOWN, issues

ROOT = Path(__file__).resolve().parents[3]
NOON = 1764331200.0  # 28 November 2025


@pytest.fixture(scope="module")
def lab_data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Sessions of five people as a window leaves them, with all that tells who they were."""
    data = tmp_path_factory.mktemp("anonymise") / "data"
    for name in ("jnd-center", "study-one"):
        text = shipped()[name].read_text(encoding="utf-8").replace("bootstrap = 2000", "") + LAB
        simulate(parse_protocol(text), {"locomotion": 10, "dance": 10}, 5, 5, data, workers=1)
    enrol(data, "sim002", age="93", sex="Female", vision="yes, -3 dpt", comments="I am Anna")
    path = data / "sub-sim002/beh/sub-sim002_task-jndcenter_run-1_beh.json"
    held = json.loads(path.read_text()) | {
        "FirstFlip": NOON, "Consent": "2025-11-28T12:00:00+00:00", "Experimenter": "Beth",
    }  # fmt: skip
    path.write_text(json.dumps(held))
    source = data / "sourcedata/sub-sim002/beh"
    source.mkdir(parents=True)
    (source / "jndcenter.lock").touch()
    (source / "sub-sim002_task-jndcenter_run-1_flips.tsv").write_text(
        f"trial\tframe\tdue\tflip\tunix_time\ntrial 1 screen 1\t0\t0.0\t0.0\t{NOON + 2.5:.6f}\n"
    )
    (source.parent / "battery_all.json").write_text('{"order": ["a", "b"], "finished": true}')
    (data / "sub-sim002/notes.txt").write_text("Anna came late")
    (data / "derivatives").mkdir()
    (data / "derivatives/report.html").write_text("sub-sim002")
    return data


@pytest.fixture(scope="module")
def copied(lab_data: Path) -> Path:
    anonymise(lab_data, lab_data.with_name("out"), np.random.default_rng(7))
    return lab_data.with_name("out")


def contents(folder: Path) -> dict[str, str]:
    files = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_text() for path in files}


def test_nobody_is_known_by_any_name_or_byte(copied: Path) -> None:
    held = contents(copied)
    for told in (*held, *held.values()):
        assert not re.search(r"sim0|Anna|Beth|dpt|1764331|2025-11-28", told)


def test_what_was_done_stays_and_the_original_too(lab_data: Path, copied: Path) -> None:
    names = new_names(lab_data, np.random.default_rng(7))
    assert sorted(names.values()) == [f"p{n:03d}" for n in range(1, 6)]
    assert list(names.values()) != sorted(names.values())
    old, new = contents(lab_data), contents(copied)
    assert old["sub-sim002/notes.txt"] == "Anna came late"
    tables = [name for name in old if name.endswith("_beh.tsv")]
    assert len(tables) == 10
    for name in tables:
        who = name.split("/")[0].removeprefix("sub-")
        assert new[name.replace(who, names[who])] == old[name]
    she = names["sim002"]
    flips = new[f"sourcedata/sub-{she}/beh/sub-{she}_task-jndcenter_run-1_flips.tsv"]
    assert flips.splitlines() == [
        "trial\tframe\tdue\tflip\tsession_time", "trial 1 screen 1\t0\t0.0\t0.0\t2.500000",
    ]  # fmt: skip
    assert json.loads(new[f"sourcedata/sub-{she}/battery_all.json"])["order"] == ["a", "b"]
    sidecar = json.loads(new[f"sub-{she}/beh/sub-{she}_task-jndcenter_run-1_beh.json"])
    assert sidecar["Consent"] == "given"
    people = {p["participant_id"]: p for p in csv.DictReader(
        new["participants.tsv"].splitlines(), delimiter="\t")}  # fmt: skip
    told = people[f"sub-{she}"]
    assert (told["age"], told["sex"], told["vision"]) == ("89", "female", "n/a")


def test_the_copy_is_sound_and_its_report_says_the_same(lab_data: Path, copied: Path) -> None:
    assert {key for key in issues(copied) if key[1:] not in UNKNOWN} == set()
    one, other = (reported(folder) for folder in (lab_data, copied))
    assert one.keys() == other.keys()
    assert len(one) > 100
    for key, value in one.items():
        assert other[key] == (
            pytest.approx(value, rel=1e-5, abs=1e-9) if isinstance(value, float) else value
        ), key


def reported(folder: Path) -> dict[str, Any]:
    """All numbers and verdicts of a report of all people, but those of one person and of seeds."""
    main(["report", str(folder), "--out", str(folder.with_name(f"report-{folder.name}"))])
    path = folder.with_name(f"report-{folder.name}") / "report.json"
    found: dict[str, Any] = {}

    def gather(value: Any, key: str) -> None:
        if isinstance(value, dict):
            if value.get("participant") in (None, "all"):
                for name, held in value.items():
                    gather(held, f"{key}/{name}")
        elif isinstance(value, list):
            for n, held in enumerate(value):
                gather(held, f"{key}/{n}")
        elif "seeds" not in key and "people" not in key and "/text" not in key:
            found[key] = value

    gather(json.loads(path.read_text())["studies"], "")
    return found


def test_faults_leave_nothing_behind(lab_data: Path, copied: Path, tmp_path: Path) -> None:
    drawn = np.random.default_rng(1)
    with pytest.raises(InputError, match="not there yet"):
        anonymise(lab_data, copied, drawn)
    with pytest.raises(InputError, match="outside"):
        anonymise(lab_data, lab_data / "more", drawn)
    with pytest.raises(InputError, match="sub-"):
        anonymise(tmp_path, tmp_path / "x", drawn)
    (tmp_path / "data/sub-a/beh").mkdir(parents=True)
    (tmp_path / "data/sub-a/beh/sub-a_task-t_run-1_beh.json").write_text("{")
    with pytest.raises(InputError, match="JSON"):
        anonymise(tmp_path / "data", tmp_path / "x", drawn)
    assert [path.name for path in tmp_path.iterdir()] == ["data"]


def test_whatever_was_left_out_is_told(
    lab_data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["anonymise", str(lab_data), "--out", str(tmp_path / "out")]) == 0
    told = capsys.readouterr()
    assert "5 people" in told.out
    assert "column comments" in told.err
    assert "Experimenter" in told.err
    assert "sub-sim002/notes.txt" in told.err
    assert set(QUESTIONS) <= set((tmp_path / "out/participants.tsv").read_text().split())


def test_every_key_that_a_session_writes_is_known() -> None:
    written = set()
    for path in (ROOT / "study").rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        written |= set(re.findall(r"save_sidecar\(\s*([A-Z]\w+)=", text))
        if path.name in ("sidecar.py", "screening.py", "lab.py", "conduct.py"):
            written |= set(re.findall(r'"([A-Z][A-Za-z]+)":', text))
    assert {"FirstFlip", "Seed", "Catch", "Battery", "ResumedOn"} <= written
    assert written - SIDECAR - TIMES <= {"Description", "StimulusSet"}
