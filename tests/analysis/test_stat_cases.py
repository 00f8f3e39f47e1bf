"""Every row of the shared cases of statistics, run as its command says.

A row here is what the command must give; the cases lie beside the checkout and are never copied.
"""

import csv
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from study.cli import main
from tests.analysis.cases import STAT, stat_case
from tests.conftest import NO_CASES

if not STAT.is_dir():
    pytest.skip(NO_CASES, allow_module_level=True)

Captured = pytest.CaptureFixture[str]


def fitted(name: str, capsys: Captured, *options: str) -> dict[str, Any]:
    assert main(["fit", str(stat_case(name)), "--json", *options]) == 0
    return json.loads(capsys.readouterr().out)


def reported(name: str, out: Path, capsys: Captured) -> tuple[dict[str, Any], str]:
    """The one study of a case, and what was said on standard error."""
    assert main(["report", str(stat_case(name)), "--out", str(out), "--json"]) == 0
    told = capsys.readouterr()
    (study,) = json.loads(told.out)["studies"]
    return study, told.err


def threshold_is(found: dict[str, Any], value: float, low: float, high: float) -> None:
    threshold = found["threshold"]
    assert threshold["value"] == pytest.approx(value, rel=1e-3)
    assert threshold["low"] == pytest.approx(low, rel=1e-3)
    assert threshold["high"] == pytest.approx(high, rel=1e-3)


def thousands(out: Path, capsys: Captured) -> None:
    threshold_is(fitted("thousands_level.csv", capsys), 3556, 2637, 4851)


def words(out: Path, capsys: Captured) -> None:
    assert fitted("true_false.csv", capsys) == fitted("true_false_as_1_0.csv", capsys)


def offset(out: Path, capsys: Captured) -> None:
    assert main(["fit", str(stat_case("offset.csv"))]) == 0
    told = capsys.readouterr().out
    for number in ("1000003.556", "1000002.637", "1000004.851"):
        assert number in told


def float_twins(out: Path, capsys: Captured) -> None:
    found = fitted("float_twins.csv", capsys)
    assert found["deviance"] == pytest.approx(0.206, abs=5e-4)
    assert found["deviance_p"] == pytest.approx(0.79, abs=0.02)


def column_twice(out: Path, capsys: Captured) -> None:
    assert main(["fit", str(stat_case("column_twice.csv"))]) == 2
    assert "found correct twice" in capsys.readouterr().err


def blank_rows(out: Path, capsys: Captured) -> None:
    threshold_is(fitted("blank_rows.csv", capsys), 3.556, 2.637, 4.851)


def all_right(out: Path, capsys: Captured) -> None:
    found = fitted("all_right.csv", capsys)
    assert found["threshold"]["value"] is None
    assert "every answer is right: the threshold lies below 1," in found["verdict"]


def below_chance(out: Path, capsys: Captured) -> None:
    found = fitted("below_chance.csv", capsys)
    assert found["threshold"]["value"] is None
    assert (
        "fewer right than by guessing (10 of 80 at a guess rate of 0.5, p < 1e-1"
        in (found["verdict"])
    )
    assert "the keys the wrong way round?" in found["verdict"]


def ids_zeros(out: Path, capsys: Captured) -> None:
    study, told = reported("ids_zeros.csv", out, capsys)
    assert study["participants"] == 12
    for number in range(1, 7):
        assert f"participant “00{number}” and “{number}”: are these one?" in told


def method_blank(out: Path, capsys: Captured) -> None:
    study, _ = reported("method_blank.csv", out, capsys)
    (comparison,) = study["comparisons"]
    assert (comparison["a"], comparison["b"], comparison["n"]) == ("fixed", "geodesic", 96)


def answer_equal(out: Path, capsys: Captured) -> None:
    study, told = reported("answer_equal.csv", out, capsys)
    assert (study["trials"], study["excluded"]) == (144, 0)
    assert (study["comparisons"][0]["n"], study["comparisons"][0]["ties"]) == (96, 48)
    assert any("48 answers of 144 called the two equal" in sentence for sentence in study["text"])
    assert "answers of another kind than first and second" in told
    assert study["with_ties"]["ties"] == 48


def chosen_against_response(out: Path, capsys: Captured) -> None:
    study, told = reported("chosen_against_response.csv", out, capsys)
    assert "p01, rows 2 to 25 (24): chosen_method is not the method that response says" in told
    assert (study["participants"], study["participants_recorded"]) == (5, 6)


def rows_twice(out: Path, capsys: Captured) -> None:
    study, told = reported("rows_twice.csv", out, capsys)
    assert study["trials"] == 144
    assert "p01, rows 146 to 169 (24) stand twice (same person, trial and answer)" in told


def correct_against_response(out: Path, capsys: Captured) -> None:
    _, told = reported("correct_against_response.csv", out, capsys)
    assert "p01, rows 2 to 61 (60): correct is not what response and odd_pair say" in told


def response_time_negative(out: Path, capsys: Captured) -> None:
    study, told = reported("response_time_negative.csv", out, capsys)
    assert "p02, rows 62 to 121 (60): response_time is negative" in told
    assert study["trials"] == 360


def rank_ties(out: Path, capsys: Captured) -> None:
    study, _ = reported("rank_ties.csv", out, capsys)
    (test,) = [test for test in study["ratings"] if test["test"] == "signed-rank, method"]
    assert (test["statistic"], test["exact"]) == (22.5, True)
    assert test["p"] == pytest.approx(0.727, abs=5e-4)


def rank_all_zero(out: Path, capsys: Captured) -> None:
    study, _ = reported("rank_all_zero.csv", out, capsys)
    for test in study["ratings"]:
        assert [test[k] for k in ("statistic", "p", "effect_size", "low", "high")] == [None] * 5
    assert "no difference but 0 in 8 people" in study["text"][0]


def semicolons(out: Path, capsys: Captured) -> None:
    study, _ = reported("semicolons.csv", out, capsys)
    assert (study["trials"], study["comparisons"][0]["prefer_a"]) == (144, 41)


def bids_sessions(out: Path, capsys: Captured) -> None:
    study, _ = reported("bids_sessions", out, capsys)
    assert (study["protocol"], study["participants"], study["trials"]) == ("x", 3, 72)
    assert "3 people took part in 6 sessions" in (out / "report.html").read_text()


def mixed(name: str, estimate: float, low: float, high: float) -> Callable[[Path, Captured], None]:
    def check(out: Path, capsys: Captured) -> None:
        study, _ = reported(name, out, capsys)
        model = study["comparisons"][0]["mixed_model"]
        assert study["comparisons"][0]["a"] == "fixed"
        assert [model["estimate"], model["low"], model["high"]] == pytest.approx(
            [estimate, low, high], abs=0.01
        )

    return check


CASES: dict[str, Callable[[Path, Captured], None]] = {
    "thousands_level.csv": thousands,
    "true_false.csv": words,
    "offset.csv": offset,
    "float_twins.csv": float_twins,
    "column_twice.csv": column_twice,
    "blank_rows.csv": blank_rows,
    "all_right.csv": all_right,
    "below_chance.csv": below_chance,
    "ids_zeros.csv": ids_zeros,
    "method_blank.csv": method_blank,
    "answer_equal.csv": answer_equal,
    "chosen_against_response.csv": chosen_against_response,
    "rows_twice.csv": rows_twice,
    "correct_against_response.csv": correct_against_response,
    "response_time_negative.csv": response_time_negative,
    "rank_ties.csv": rank_ties,
    "rank_all_zero.csv": rank_all_zero,
    "semicolons.csv": semicolons,
    "bids_sessions": bids_sessions,
    "mixed_split.csv": mixed("mixed_split.csv", -3.11, -7.35, 1.13),
    "mixed_people_1.csv": mixed("mixed_people_1.csv", 3.02, 1.14, 4.91),
    "mixed_people_3.csv": mixed("mixed_people_3.csv", 3.55, 0.16, 6.94),
}


@pytest.mark.parametrize("name", CASES)
def test_the_case_is_as_it_should_be(name: str, tmp_path: Path, capsys: Captured) -> None:
    CASES[name](tmp_path / "out", capsys)


def test_every_case_that_is_expected_is_here() -> None:
    with stat_case("EXPECTED.csv").open(newline="") as file:
        assert [row["file"] for row in csv.DictReader(file)] == list(CASES)
    assert STAT.name == "stat"
