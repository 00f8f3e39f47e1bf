"""`segue fit`: tables in, JSON out, refusals in one or two lines."""

import json
from pathlib import Path

import pytest

from study.cli import main

PALAMEDES = (
    "level,correct,total\n.01,59,100\n.03,53,100\n.05,68,100\n.07,83,100\n.09,92,100\n.11,99,100\n"
)


def fitted(table: Path, capsys: pytest.CaptureFixture[str], *options: str) -> dict:
    assert main(["fit", str(table), "--json", *options]) == 0
    return json.loads(capsys.readouterr().out)


def test_json_of_a_table_of_counts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = tmp_path / "t.csv"
    table.write_text(PALAMEDES)
    found = fitted(table, capsys, "--lapse", "0")
    assert list(found) == ["location", "slope", "guess", "lapse", "log_likelihood", "deviance",
                           "deviance_p", "threshold", "interval_method", "verdict"]  # fmt: skip
    assert found["location"] == pytest.approx(0.060126, abs=5e-7)
    assert found["interval_method"] == "profile likelihood"
    assert fitted(table, capsys, "--bootstrap", "200")["interval_method"] == (
        "parametric bootstrap, 200 samples"
    )


def test_single_trials_and_counts_agree(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    counted, single = tmp_path / "counts.csv", tmp_path / "single.csv"
    counted.write_text("level,correct,total\n1,3,6\n2,4,6\n3,6,6\n")
    rows = [(1, 3), (2, 4), (3, 6)]
    single.write_text(
        "level,correct\n"
        + "".join(f"{level},{int(n < right)}\n" for level, right in rows for n in range(6))
    )
    assert fitted(counted, capsys) == fitted(single, capsys)


def test_a_denied_threshold_is_null(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = tmp_path / "t.csv"
    table.write_text("level,correct,total\n1,5,10\n2,6,10\n3,4,10\n4,5,10\n")
    found = fitted(table, capsys)
    assert found["threshold"]["value"] is None
    assert found["verdict"].startswith("not identifiable: ")
    assert main(["fit", str(table)]) == 0
    assert "not identifiable" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        ("a,b\n1,2\n", (), "expected columns level,correct,total"),
        ("", (), "an empty file"),
        ("level,correct\n", (), "at least one row"),
        ("level,correct,total\n1,x,3\n", (), "t.csv:2: expected numbers"),
        ("level,correct,total\n1,4,3\n", (), "row 1: expected whole counts"),
        ("level,correct\n1,3\n", (), "add a column total"),
        (PALAMEDES, ("--at", "0.4"), "--at: expected a proportion"),
        (PALAMEDES, ("--lapse", "some"), "--lapse: expected free or a rate"),
        (PALAMEDES, ("--lapse", "0.7"), "guess and lapse"),
        (PALAMEDES, ("--bootstrap", "-1"), "--bootstrap: expected 0 or more"),
    ],
)
def test_refusals(
    text: str, options: tuple, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "t.csv"
    table.write_text(text)
    assert main(["fit", str(table), *options]) == 2
    told = capsys.readouterr().err
    assert message in told
    assert len(told.strip().splitlines()) <= 2


def test_an_absent_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["fit", str(tmp_path / "no.csv")]) == 2
    assert "expected a CSV table" in capsys.readouterr().err
