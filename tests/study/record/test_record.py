"""The record: synced rows, torn lines, runs of a participant, IDs that are refused."""

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stimuli.errors import InputError, InputWarning
from study.protocol.schema import Lab
from study.record.dataset import (
    check_participant,
    check_twin,
    enrol,
    prepare,
    record_path,
    runs,
    unfinished,
)
from study.record.table import COMMON, Record, create, reopen
from study.trials.reading import parse_protocol

ROW = {"trial": 1, "phase": "main", "onset": 1.5, "response": "1", "void": False}


def test_a_row_is_on_the_disk_when_append_returns(tmp_path: Path) -> None:
    record = create(tmp_path / "a_beh.tsv", tuple(COMMON), {"Seed": 1})
    record.append(ROW)
    line = (tmp_path / "a_beh.tsv").read_text().splitlines()[1].split("\t")
    assert dict(zip(COMMON, line, strict=True)) == {
        "trial": "1",
        "phase": "main",
        "repeat_of": "n/a",
        "onset": "1.500000",
        "response": "1",
        "response_time": "n/a",
        "late_frames": "n/a",
        "void": "0",
        "replays": "n/a",
        "clip_a": "n/a",
        "clip_b": "n/a",
    }


def test_a_record_is_never_overwritten(tmp_path: Path) -> None:
    create(tmp_path / "a_beh.tsv", tuple(COMMON), {})
    with pytest.raises(FileExistsError):
        create(tmp_path / "a_beh.tsv", tuple(COMMON), {})


@given(cut=st.integers(1, 30))
def test_a_line_cut_by_a_kill_is_set_aside(tmp_path_factory, cut: int) -> None:
    folder = tmp_path_factory.mktemp("torn")
    record = create(folder / "a_beh.tsv", tuple(COMMON), {})
    record.append(ROW)
    whole = record.path.read_bytes()
    record.append({**ROW, "trial": 2})
    torn = record.path.read_bytes()[: len(whole) + cut]
    record.path.write_bytes(torn)
    assert [row["trial"] for row in reopen(record.path).rows()] == ["1"]
    assert record.path.with_suffix(".torn").read_bytes() == torn[len(whole) :]
    assert record.path.read_bytes() == whole


def test_the_sidecar_is_written_whole(tmp_path: Path) -> None:
    record = create(tmp_path / "a_beh.tsv", tuple(COMMON), {"Seed": 7})
    record.save_sidecar(Finished=True)
    assert json.loads(record.sidecar_path.read_text()) == {"Seed": 7, "Finished": True}
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a_beh.json", "a_beh.tsv"]


@pytest.mark.parametrize("name", ["../../x", "", "a b", "a" * 33, "é", "x\n", "sub-1"])
def test_ids_are_refused_never_rewritten(name: str) -> None:
    with pytest.raises(InputError, match="letters and digits"):
        check_participant(name)


def test_participants_keep_what_is_known_of_them(tmp_path: Path) -> None:
    prepare(tmp_path, Lab())
    enrol(tmp_path, "p1", age="30")
    enrol(tmp_path, "p2", observer="human")
    enrol(tmp_path, "p1", comments="fine")
    lines = [line.split("\t") for line in (tmp_path / "participants.tsv").read_text().splitlines()]
    table = [dict(zip(lines[0], line, strict=True)) for line in lines[1:]]
    assert [(r["participant_id"], r["age"], r["comments"], r["observer"]) for r in table] == [
        ("sub-p1", "30", "fine", "n/a"),
        ("sub-p2", "n/a", "n/a", "human"),
    ]


def test_runs_are_found_by_number(tmp_path: Path) -> None:
    for run in (2, 1, 10):
        create(record_path(tmp_path, "p1", "jnd", run), tuple(COMMON), {})
    create(record_path(tmp_path, "p1", "jndx", 3), tuple(COMMON), {})
    assert list(runs(tmp_path, "p1", "jnd")) == [1, 2, 10]


PREFERENCE = """
name = "runs"
task = "preference"
methods = ["geodesic", "fixed"]
[stimuli]
motions = [{ name = "m", from = "a", to = "b" }]
[sets.sample]
a = { clip = "x", frame = 1 }
b = { clip = "y", frame = 2 }
"""


def begun(data: Path, run: int, **sidecar: object) -> Record:
    return create(record_path(data, "p1", "runs", run), tuple(COMMON), sidecar)


def test_a_table_never_stands_without_its_sidecar(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def killed(self: Record, **changes: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Record, "save_sidecar", killed)
    with pytest.raises(KeyboardInterrupt):
        begun(tmp_path, 1)
    assert runs(tmp_path, "p1", "runs") == {}


def test_only_the_latest_run_of_a_kind_can_be_unfinished(tmp_path: Path) -> None:
    protocol = parse_protocol(PREFERENCE)
    assert unfinished(tmp_path, "p1", protocol, rehearsal=False) is None
    left = begun(tmp_path, 1, Finished=False)
    begun(tmp_path, 2, Finished=True, Rehearsal=True)
    found = unfinished(tmp_path, "p1", protocol, rehearsal=False)
    assert found is not None
    assert found.path == left.path
    assert unfinished(tmp_path, "p1", protocol, rehearsal=True) is None
    begun(tmp_path, 3, Finished=True)
    assert unfinished(tmp_path, "p1", protocol, rehearsal=False) is None


def test_a_run_without_sidecar_says_how_to_go_on(tmp_path: Path) -> None:
    begun(tmp_path, 1).sidecar_path.unlink()
    with pytest.raises(InputError, match="--restart"):
        unfinished(tmp_path, "p1", parse_protocol(PREFERENCE), rehearsal=False)


@pytest.mark.parametrize(
    ("there", "name", "outcome"),
    [
        ("P01", "p01", "refused"),
        ("sim1", "SIM1", "refused"),
        ("1", "001", "told"),
        ("p01", "P1", "told"),
        ("a1b02", "a1b2", "told"),
        ("p1", "p10", "nothing"),
        ("p01", "p01", "nothing"),
    ],
)
def test_people_whom_disks_or_people_confuse_are_told_apart(
    tmp_path: Path, there: str, name: str, outcome: str
) -> None:
    (tmp_path / f"sub-{there}").mkdir()
    if outcome == "refused":
        with pytest.raises(InputError, match=there):
            check_twin(tmp_path, name)
    elif outcome == "told":
        with pytest.warns(InputWarning, match=there):
            check_twin(tmp_path, name)
    else:
        check_twin(tmp_path, name)
