"""Records that repeat or contradict themselves: each kind is named, and what is done is said."""

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis.consistency import line_ranges
from analysis.record import read
from analysis.repeats import lookalikes
from analysis.report import write_report
from study.cli import main
from tests.analysis import records

Row = dict[str, Any]


def odd_pair_table(people: int = 4, trials: int = 30, seed: int = 0) -> list[Row]:
    rng = np.random.default_rng(seed)
    rows = []
    for person in range(people):
        for trial in range(trials):
            sign, level = (-1, 1)[trial % 2], int(rng.choice([2, 4, 6, 8]))
            odd, right = int(rng.integers(1, 3)), bool(rng.random() < 0.5 + level / 20)
            rows.append(
                {
                    "participant": f"p{person + 1:02d}",
                    "trial": trial + 1,
                    "track": "shorter" if sign < 0 else "longer",
                    "reference_length": 10,
                    "length": 10 + sign * level,
                    "difference": sign * level,
                    "odd_pair": odd,
                    "response": odd if right else 3 - odd,
                    "correct": int(right),
                    "response_time": round(float(rng.lognormal(0, 0.4)), 3),
                }
            )
    return rows


def preference_table(people: int = 4, trials: int = 24, seed: int = 0) -> list[Row]:
    rng = np.random.default_rng(seed)
    rows = []
    for person in range(people):
        for trial in range(trials):
            first, second = map(str, rng.permutation(["fixed", "geodesic"]))
            answer = str(rng.choice(["first", "second"]))
            rows.append(
                {
                    "participant": f"p{person + 1:02d}",
                    "trial": trial + 1,
                    "motion": f"m{trial % 8 + 1}",
                    "first_method": first,
                    "second_method": second,
                    "response": answer,
                    "chosen_method": first if answer == "first" else second,
                }
            )
    return rows


def written(path: Path, rows: list[Row], delimiter: str = ",", encoding: str = "utf-8") -> Path:
    with path.open("w", newline="", encoding=encoding) as file:
        table = csv.DictWriter(file, list(rows[0]), delimiter=delimiter)
        table.writeheader()
        table.writerows(rows)
    return path


def of(person: str, rows: list[Row]) -> list[Row]:
    return [row for row in rows if row["participant"] == person]


def changed(rows: list[Row], person: str, **columns: Callable[[Row], Any]) -> list[Row]:
    """The rows with some columns of one person's worked out otherwise."""
    return [
        row | {name: value(row) for name, value in columns.items()}
        if row["participant"] == person
        else row
        for row in rows
    ]


def other(row: Row) -> str:
    return next(m for m in ("fixed", "geodesic") if m != row["chosen_method"])


CONTRADICTIONS: dict[str, tuple[list[Row], str, str, int]] = {
    "correct": (
        changed(odd_pair_table(), "p02", correct=lambda r: 1 - r["correct"]),
        "p02, rows 32 to 61 (30): correct is not what response and odd_pair say",
        "not used until",
        90,
    ),
    "chosen": (
        changed(preference_table(), "p03", chosen_method=other),
        "p03, rows 50 to 73 (24): chosen_method is not the method that response says",
        "not used until",
        72,
    ),
    "mirrored difference": (
        changed(odd_pair_table(), "p01", difference=lambda r: -r["difference"]),
        "p01, rows 2 to 31 (30): difference is not length − reference_length, which the track",
        "worked out anew from the lengths",
        120,
    ),
    "other difference": (
        changed(odd_pair_table(), "p01", difference=lambda r: r["difference"] * 2),
        "p01, rows 2 to 31 (30): difference is not length − reference_length",
        "not used until",
        90,
    ),
    "track": (
        changed(odd_pair_table(), "p01", track=lambda r: "longer"),
        "track is not the side that difference says",
        "not used until",
        105,
    ),
    "negative times": (
        changed(odd_pair_table(), "p04", response_time=lambda r: -r["response_time"]),
        "p04, rows 92 to 121 (30): response_time is negative",
        "the times are not used, the answers are",
        120,
    ),
    "milliseconds": (
        changed(odd_pair_table(), "p04", response_time=lambda r: 1000 * r["response_time"]),
        "p04, rows 92 to 121 (30): response_time can only be milliseconds",
        "read as such",
        120,
    ),
    "rows twice": (
        [*preference_table(), *of("p02", preference_table())],
        "p02, rows 98 to 121 (24) stand twice",
        "counted once",
        96,
    ),
    "a person copied": (
        [*odd_pair_table(), *({**r, "participant": "p05"} for r in of("p02", odd_pair_table()))],
        "p05, rows 122 to 151 (30): a copy of p02 in",
        "counted once",
        120,
    ),
    "a person copied, without times": (
        [*preference_table(), *({**r, "participant": "p9"} for r in of("p01", preference_table()))],
        "p9, rows 98 to 121 (24): a copy of p01 in",
        "counted once",
        96,
    ),
    "a run copied": (
        [
            {**row, "run": run}
            for run, seed in (("1", 0), ("2", 1), ("3", 0))
            for row in of("p01", odd_pair_table(seed=seed))
        ],
        "p01, rows 62 to 91 (30): a copy of p01 in",
        "counted once",
        60,
    ),
    "ties": (
        changed(
            preference_table(), "p02", response=lambda r: "Equal", chosen_method=lambda r: "n/a"
        ),
        "p02, rows 26 to 49 (24): answers of another kind than first and second",
        "counted as ties",
        96,
    ),
    "answers of no kind": (
        changed(preference_table(), "p02", response=lambda r: "hm", chosen_method=lambda r: "n/a"),
        "p02, rows 26 to 49 (24): response is neither first, second nor a tie",
        "count as no answer",
        72,
    ),
}


@pytest.mark.parametrize("kind", CONTRADICTIONS)
def test_each_kind_is_named_and_what_is_done_is_said(kind: str, tmp_path: Path) -> None:
    rows, what, done, left = CONTRADICTIONS[kind]
    path = written(tmp_path / "t.csv", rows)
    found = write_report([path], tmp_path / "out").document["studies"][0]
    told = [remark for remark in found["remarks"] if what in remark]
    assert told, found["remarks"]
    assert told[0].startswith(f"{path}: ")
    assert done in told[0]
    assert found["trials"] == left
    assert told[0] in found["faults"]


@pytest.mark.parametrize("table", [odd_pair_table(), preference_table()])
def test_a_sound_table_is_read_without_a_remark(table: list[Row], tmp_path: Path) -> None:
    (study,), notes = read([written(tmp_path / "t.csv", table)])
    assert (study.remarks, study.faults, notes) == ((), (), [])
    assert len(study.trials) == len(table)


def test_people_who_answer_alike_are_no_copies(tmp_path: Path) -> None:
    """In one order for all, everyone who always prefers one method has the same rows."""
    rows = [
        {"participant": f"p{person}", "trial": trial, "motion": f"m{trial}",
         "first_method": "fixed" if trial % 2 else "geodesic",
         "second_method": "geodesic" if trial % 2 else "fixed",
         "response": "second" if trial % 2 else "first", "chosen_method": "geodesic"}
        for person in range(6)
        for trial in range(24)
    ]  # fmt: skip
    (study,), _ = read([written(tmp_path / "t.csv", rows)])
    assert len(study.trials) == 144
    assert study.remarks == ()


def test_two_sessions_with_equal_rows_are_one(tmp_path: Path) -> None:
    """The same seed gave two people the same session: one of them is counted."""
    rng = np.random.default_rng(0)
    protocol, rows = records.odd_pair_protocol(), records.odd_pair_rows(rng)
    for row in rows:
        row["response_time"] = f"{rng.lognormal(0, 0.3):.6f}"
    others = records.odd_pair_rows(rng)
    records.write_dataset(tmp_path, protocol, {"a": rows, "b": rows, "c": others})
    (study,), _ = read([tmp_path])
    assert [session.participant for session in study.sessions] == ["a", "c"]
    (told,) = study.remarks
    assert "sub-b_task" in told
    assert "a copy of a in" in told


def test_times_in_milliseconds_are_read_in_seconds(tmp_path: Path) -> None:
    rows, *_ = CONTRADICTIONS["milliseconds"]
    (study,), _ = read([written(tmp_path / "t.csv", rows)])
    times = study.trials.groupby("participant")["response_time"].median()
    assert times.max() < 3


def test_a_mirrored_difference_comes_right_by_the_lengths(tmp_path: Path) -> None:
    rows, *_ = CONTRADICTIONS["mirrored difference"]
    (study,), _ = read([written(tmp_path / "t.csv", rows)])
    assert list(study.trials["difference"]) == [row["difference"] for row in odd_pair_table()]


@pytest.mark.parametrize(
    ("own", "written_so", "asked"),
    [
        ("p01", "p01 ", None),
        ("p01", "P01", "participant “P01” and “p01”"),
        ("p01", "p 01", "participant “p 01” and “p01”"),
        ("fixed", "fixed ", None),
        ("fixed", "Fixed", "method “Fixed” and “fixed”"),
        ("m1", "M1", "motion “M1” and “m1”"),
    ],
)
def test_names_that_may_be_one(
    own: str, written_so: str, asked: str | None, tmp_path: Path
) -> None:
    rows = preference_table()
    for row in rows[::3]:
        for column, value in row.items():
            row[column] = written_so if value == own else value
    (study,), _ = read([written(tmp_path / "t.csv", rows)])
    told = [remark for remark in study.remarks if "are these one?" in remark]
    assert [asked is not None and asked in remark for remark in told] == [True] * (
        asked is not None
    )
    assert study.trials["participant"].nunique() == 4 + ("participant" in (asked or ""))


def test_zeros_that_a_spreadsheet_strips() -> None:
    assert lookalikes(["001", "1", "010", "10", "2", "0", "00"]) == [
        ("0", "00"), ("001", "1"), ("010", "10"),
    ]  # fmt: skip


def test_lines_in_words() -> None:
    assert line_ranges([2, 3, 4, 9]) == "rows 2 to 4 and 9"
    assert line_ranges([7]) == "row 7"
    assert line_ranges(range(0, 60, 2)).endswith("and 19 more stretches")


@pytest.mark.parametrize(
    ("delimiter", "encoding", "first"),
    [
        (";", "utf-8", ""),
        ("\t", "utf-8", ""),
        (",", "utf-16", ""),
        (";", "utf-16-le", ""),
        (";", "utf-16-be", ""),
        (";", "utf-8-sig", "sep=;\n"),
    ],
)
def test_tables_as_spreadsheets_write_them(
    delimiter: str, encoding: str, first: str, tmp_path: Path
) -> None:
    path = written(tmp_path / "t.csv", preference_table(), delimiter)
    text = path.read_text() + f"{delimiter * 6}\n" * 3
    path.write_bytes((first + text).encode(encoding))
    (study,), _ = read([path])
    assert len(study.trials) == 96
    assert study.faults == ()


def test_the_minus_sign_of_typesetters_and_decimal_commas(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_text("difference;correct;response_time\n−4;richtig;0,5\n−6;TRUE;0,7\n6;wrong;0,9\n")
    (study,), _ = read([path])
    assert list(study.trials["difference"]) == [-6, 6]
    assert list(study.trials["correct"]) == [1, 0]
    assert list(study.trials["response_time"]) == [0.7, 0.9]
    assert "t.csv:2: correct: expected 0 or 1, found 'richtig'" in study.faults[0]


@pytest.mark.parametrize("entities", ["_ses-{run}_task-x", "_ses-{run}_task-x_acq-lab_run-1"])
def test_sessions_and_acquisitions_of_bids_are_one_study(entities: str, tmp_path: Path) -> None:
    rows = preference_table()
    for person in ("p01", "p02", "p03"):
        own = of(person, rows)
        for run, part in (("1", own[:12]), ("2", own[12:])):
            name = f"sub-{person}{entities.format(run=run)}_beh.tsv"
            folder = tmp_path / f"sub-{person}" / f"ses-{run}" / "beh"
            folder.mkdir(parents=True)
            kept = [{k: v for k, v in row.items() if k != "participant"} for row in part]
            written(folder / name, kept, "\t")
            (folder / f"._{name}").write_bytes(b"\0\5\26\7 left by a Mac")
    (study,), notes = read([tmp_path])
    assert (study.name, len(study.sessions), notes) == ("x", 6, [])
    assert sorted(set(study.trials["participant"])) == ["p01", "p02", "p03"]
    assert {session.run.split("-")[0] for session in study.sessions} == {"1", "2"}


FOREIGN = {
    "psychopy": "stim,key_resp.keys,key_resp.corr,key_resp.rt,expName\n4,left,1,.5,x\n",
    "jspsych": "rt,stimulus,response,trial_type,correct_response,subject\n511,a,f,html,f,s1\n",
    "long": "subj;stim;acc\ns1;4;1\ns1;2;0\n",
}


@pytest.mark.parametrize("kind", FOREIGN)
def test_a_table_of_another_tool_is_no_empty_report(
    kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "t.csv"
    path.write_text(FOREIGN[kind])
    assert main(["report", str(path), "--out", str(tmp_path / "out")]) == 1
    told = capsys.readouterr().err
    assert "expected the columns of a record: difference" in told
    assert FOREIGN[kind].split("\n")[0].replace(";", ",").split(",")[0] in told
    assert "--columns" in told
    assert not (tmp_path / "out").exists()


def test_columns_of_another_name_are_mapped(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rng = np.random.default_rng(0)
    rows = [
        {"subj": f"s{person}", "stim": level, "acc": int(rng.random() < 0.5 + level / 16)}
        for person in range(3)
        for level in (1, 3, 5, 7)
        for _ in range(20)
    ]
    path = written(tmp_path / "t.csv", rows)
    options = ["--out", str(tmp_path / "out"), "--json"]
    named = ["--columns", "participant=subj,level=stim,correct=acc"]
    assert main(["report", str(path), *options, *named]) == 0
    captured = capsys.readouterr()
    assert '"participants": 3' in captured.out
    assert main(["report", str(path), *options, "--columns", "participant=who"]) == 1
    assert "--columns: expected a column who, found subj, stim, acc" in capsys.readouterr().err
    assert main(["report", str(path), *options, "--columns", "participant"]) == 2
    assert "--columns: expected names as in" in capsys.readouterr().err
