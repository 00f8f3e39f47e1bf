"""Reading records, whole ones and damaged ones."""

import json
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analysis.errors import InputError
from analysis.record import read
from analysis.screening import screen
from tests.analysis import records


def test_a_data_set_is_one_study(jnd: Path) -> None:
    (study,), notes = read([jnd])
    assert (study.name, study.task, len(study.sessions), notes) == (
        "jnd-center",
        "odd-pair",
        6,
        [],
    )
    assert study.protocol["source"] == "Wang 2005, VI.3.1"
    assert len(study.participants) == 6
    assert study.faults == ()


def test_nothing_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="found nothing there"):
        read([tmp_path / "no"])
    with pytest.raises(InputError, match=r"expected session tables"):
        read([tmp_path])


def damaged(root: Path, text: str) -> Path:
    path = root / "sub-x" / "beh" / "sub-x_task-jndcenter_run-1_beh.tsv"
    path.parent.mkdir(parents=True)
    path.write_text(text)
    return path


def test_malformed_rows_are_named_and_left_out(tmp_path: Path) -> None:
    header = "trial\tmotion\treference_length\tlength\tresponse\todd_pair\tlate_frames\n"
    rows = [
        "1\twalk\t10\t14\t1\t1\t0",
        "2\twalk\t10\tlong\t1\t1\t0",
        "3\twalk\t10\t14",
        "4\twalk\t10\t10\t1\t1\t0",
        "5\twalk\t10\t6\t2\t1\tinf",
        "6\t<b>\t10\t6\t2\t1\tn/a",
    ]
    path = damaged(tmp_path, header + "\n".join(rows) + "\n")
    (study,), _ = read([tmp_path])
    assert list(study.trials["trial"]) == [1, 6]
    assert list(study.trials["correct"]) == [1, 0]
    assert list(study.trials["track"]) == ["longer", "shorter"]
    assert [fault.removeprefix(f"{path}:")[0] for fault in study.faults] == ["4", "3", "5", "6"]
    assert all("left out" in fault for fault in study.faults)


def test_a_foreign_table_and_a_torn_sidecar_do_not_stop_the_rest(tmp_path: Path) -> None:
    good = damaged(tmp_path, "difference\tcorrect\n3\t1\n")
    good.with_suffix(".json").write_text("{not json")
    other = tmp_path / "sub-y" / "beh" / "sub-y_task-z_run-1_beh.tsv"
    other.parent.mkdir(parents=True)
    other.write_text("a\tb\n1\t2\n")
    (study,), notes = read([tmp_path])
    assert len(study.trials) == 1
    assert "not readable as JSON" in study.faults[0]
    assert len(notes) == 1
    assert "expected the columns of a record" in notes[0]


def test_a_table_made_by_hand(tmp_path: Path) -> None:
    path = tmp_path / "mine.csv"
    path.write_text("participant,difference,correct\nann,4,1\nbob,-3,0\n")
    (study,), _ = read([path])
    assert list(study.trials["participant"]) == ["ann", "bob"]
    assert study.task == "odd-pair"


def test_rehearsals_are_never_pooled(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    protocol = records.odd_pair_protocol()
    records.write_dataset(tmp_path, protocol, {"a": records.odd_pair_rows(rng)})
    records.write_dataset(tmp_path, protocol, {"b": records.odd_pair_rows(rng)}, Rehearsal=True)
    records.write_dataset(tmp_path, protocol, {"c": records.odd_pair_rows(rng)}, Pace=20.0)
    (study,), _ = read([tmp_path])
    assert [session.participant for session in study.sessions] == ["a"]
    assert len(study.set_aside) == 2
    assert not study.rehearsal
    (alone,), _ = read([tmp_path / "sub-b"])
    assert alone.rehearsal


def test_people_of_one_name_in_two_data_sets_stay_two(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    for name in ("one", "two"):
        rows = {"a": records.odd_pair_rows(rng)}
        records.write_dataset(tmp_path / name, records.odd_pair_protocol(), rows)
    (study,), _ = read([tmp_path / "one", tmp_path / "two"])
    assert set(study.trials["participant"]) == {"a@one", "a@two"}


def test_a_session_without_sidecar_joins_its_study(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    rows = {"a": records.odd_pair_rows(rng), "b": records.odd_pair_rows(rng)}
    records.write_dataset(tmp_path, records.odd_pair_protocol(), rows)
    next(tmp_path.glob("sub-b/beh/*.json")).unlink()
    (study,), _ = read([tmp_path])
    assert len(study.sessions) == 2


def test_two_versions_of_a_protocol_are_two_studies(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    for person, at in (("a", [0.7]), ("b", [0.75])):
        protocol = records.odd_pair_protocol(analysis={"at": at})
        records.write_dataset(tmp_path, protocol, {person: records.odd_pair_rows(rng)})
    studies, _ = read([tmp_path])
    assert len(studies) == 2


def test_sidecar_of_a_wrong_kind(tmp_path: Path) -> None:
    path = damaged(tmp_path, "difference\tcorrect\n3\t1\n")
    path.with_suffix(".json").write_text(json.dumps(["list"]))
    (study,), _ = read([tmp_path])
    assert "expected a JSON object" in study.faults[0]


def test_a_column_named_twice_is_read_once(tmp_path: Path) -> None:
    damaged(tmp_path, "difference\tcorrect\tdifference\n3\t1\t5\n")
    (study,), _ = read([tmp_path])
    assert list(study.trials["difference"]) == [3]
    assert "expected each column once" in study.faults[0]


TABLE = (
    "trial\tphase\tresponse\tlate_frames\tvoid\tmotion\treference_length\tlength\tdifference\t"
    "odd_pair\tcorrect\n"
    "1\tmain\t1\t0\t0\twalk\t10\t14\t4\t1\t1\n"
    "2\tmain\t2\t0\t0\twalk\t10\t6\t-4\t1\t0\n"
)


@settings(max_examples=150)
@given(
    at=st.integers(0, len(TABLE)),
    length=st.integers(0, 12),
    text=st.text(max_size=8),
    protocol=st.sampled_from([None, {"task": "odd-pair", "analysis": 3}, {"task": "juggling"}, 7]),
)
def test_no_damage_stops_the_reading(at: int, length: int, text: str, protocol: object) -> None:
    """Whatever a stretch of the file turns into, rows are read or named, and nothing raises."""
    with TemporaryDirectory() as folder:
        path = damaged(Path(folder), "")
        path.write_text(TABLE[:at] + text + TABLE[at + length :], encoding="utf-8", newline="")
        if protocol is not None:
            path.with_suffix(".json").write_text(json.dumps({"Protocol": protocol}))
        studies = []
        with suppress(InputError):
            studies, _ = read([Path(folder)])
        for study in studies:
            assert screen(study).excluded >= 0
