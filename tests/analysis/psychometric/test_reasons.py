"""What a fit says where it gives no number, and what it makes of tables of laboratories."""

import json
from pathlib import Path

import numpy as np
import pytest

from analysis.psychometric import (
    FUNCTIONS,
    counts,
    fit_batch,
    location_for,
    people_counts,
    proportion,
    setting,
    summarise,
)
from analysis.psychometric.counts import merged
from analysis.psychometric.profile import threshold_interval
from analysis.psychometric.summary import Threshold, threshold_dict
from analysis.psychometric.verdict import judge
from study.cli import main

LEVELS = [1, 2, 3, 4]


@pytest.mark.parametrize("function", FUNCTIONS)
@pytest.mark.parametrize(
    ("right", "total", "said"),
    [
        ([20, 20, 20, 20], 20, "every answer is right: the threshold lies below 1"),
        ([199, 200, 198, 200], 200, "nearly every answer is right at every level"),
        (
            [0, 0, 0, 0],
            20,
            "by guessing (0 of 80 at a guess rate of 0.5, p < 1e-2",
        ),
        ([3, 2, 4, 1], 20, "are the keys the wrong way round?"),
        ([12, 7, 4, 1], 20, "fewer right than by guessing"),
        ([11, 9, 12, 10], 20, "the levels make no difference"),
        ([38, 34, 28, 20], 40, "the proportion right falls"),
    ],
)
def test_reasons_say_what_to_do(function: str, right: list[int], total: int, said: str) -> None:
    found = summarise(counts(LEVELS, right, [total] * 4), setting(function), samples=0)
    assert found.verdict.startswith("not identifiable: ")
    assert said in found.verdict
    assert found.as_dict()["threshold"]["value"] is None


def test_one_level_is_too_few() -> None:
    found = summarise(counts([3], [30], [40]), setting("logistic"), samples=0)
    assert found.verdict == "not identifiable: only one level was shown: show more"


def missed(lapse: float, sets: int, seed: int, bound: float = 0.2) -> tuple[float, float]:
    """Shares of sets called ok, and of those whose interval holds the truth."""
    rng = np.random.default_rng(seed)
    levels, truth = np.arange(1.0, 9.0), rng.uniform(3, 5, sets)
    at = 0.7
    location = location_for("logistic", truth, at, 1.4, 0.5, lapse)
    p = proportion("logistic", levels, location[:, None], 1.4, 0.5, lapse)
    right = rng.binomial(40, p).astype(float)
    total = np.full_like(right, 40.0)
    what = setting("logistic", lapse_bound=bound)
    fits = fit_batch(levels, right, total, what)
    ok = judge(levels, fits, right, total, at)[0] == 0
    low, high = threshold_interval(fits, right, total, at)
    held = (low <= truth) & (truth <= high)
    return float(ok.mean()), float(held[ok].mean()) if ok.any() else 1.0


@pytest.mark.parametrize("lapse", [0.02, 0.15])
def test_what_is_called_ok_covers_where_people_lapse(lapse: float) -> None:
    """150 sets at .95: three binomial standard errors are .053."""
    ok, covered = missed(lapse, 150, 3)
    assert ok > 0.5
    assert covered >= 0.95 - 0.053


@pytest.mark.slow
@pytest.mark.parametrize("lapse", [0.0, 0.05, 0.1, 0.15, 0.2, 0.25])
def test_certify_coverage_where_people_lapse(lapse: float) -> None:
    ok, covered = missed(lapse, 1000, 4)
    print(f"\nlapse {lapse}: ok {ok:.3f}, of these the 95% interval covers {covered:.3f}")
    assert covered >= 0.93


def test_a_lapse_rate_at_its_bound_is_said_and_the_bound_is_a_setting(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "t.csv"
    table.write_text("level,correct,total\n1,20,40\n2,22,40\n3,31,40\n4,34,40\n5,33,40\n6,34,40\n")
    assert main(["fit", str(table), "--json", "--lapse-bound", "0.05", "--at", "0.7"]) == 0
    assert (
        "the lapse rate is at its bound of 0.05" in json.loads(capsys.readouterr().out)["verdict"]
    )
    assert main(["fit", str(table), "--json", "--at", "0.7"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["verdict"] == "ok"
    assert 0.1 < found["lapse"] < 0.2


def test_ends_beyond_the_levels_are_no_numbers() -> None:
    cut = Threshold(0.75, 6.5, -3.0, 9.5, 1.0, 8.0)
    assert threshold_dict(cut, "ok") == {
        "at": 0.75, "value": 6.5, "low": None, "high": None,
        "low_reason": "beyond 1, the last level shown",
        "high_reason": "beyond 8, the last level shown",
    }  # fmt: skip
    signed = threshold_dict(cut.signed_down, "ok")
    assert (signed["value"], signed["low_reason"]) == (-6.5, "beyond −8, the last level shown")
    assert threshold_dict(cut, "not identifiable: why")["low"] is None
    assert "low_reason" not in threshold_dict(Threshold(0.75, 3.0, 2.0, 4.0, 1.0, 8.0), "ok")


def test_a_fit_whose_interval_passes_the_last_level(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "t.csv"
    table.write_text("level,correct,total\n1,20,40\n2,20,40\n3,22,40\n4,26,40\n5,31,40\n")
    assert main(["fit", str(table), "--lapse", "0", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["verdict"] == "ok"
    assert found["threshold"]["high"] is None
    assert found["threshold"]["high_reason"] == "beyond 5, the last level shown"
    assert main(["fit", str(table), "--lapse", "0"]) == 0
    assert "high beyond 5\n" in capsys.readouterr().out


@pytest.mark.parametrize("base", [0.0, 1000.0, -3.0])
def test_levels_that_differ_in_the_last_bit_are_one(base: float) -> None:
    steps = [base + sum([0.1] * n) for n in range(1, 9)]
    typed = [round(base + 0.1 * n, 1) for n in range(1, 9)]
    levels = np.array(steps + typed)
    assert len(merged(levels)[0]) == 8
    found = counts(levels, np.ones(16))
    assert list(found.total) == [2.0] * 8
    people = people_counts(["a"] * 8 + ["b"] * 8, levels, [1.0] * 16)
    assert people.total.tolist() == [[1.0] * 8] * 2


def test_levels_far_from_zero_stay_apart() -> None:
    assert len(merged(np.array([1e6, 1e6 + 1e-4, 1e6 + 2e-4]))[0]) == 3


PLAIN = "level,correct\n" + "".join(f"{n},{int(k < 4 + n)}\n" for n in (1, 2, 3) for k in range(8))


@pytest.mark.parametrize(
    ("right", "wrong"),
    [("TRUE", "FALSE"), ("true", "false"), ("yes", "no"), ("Right", "Wrong"), ("1.0", "0")],
)
@pytest.mark.parametrize(("separator", "first"), [(",", ""), (";", "sep=;\n"), ("\t", "")])
def test_answers_and_separators_as_laboratories_write_them(
    right: str, wrong: str, separator: str, first: str, tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    plain, other = tmp_path / "plain.csv", tmp_path / "other.csv"
    plain.write_text(PLAIN)
    rows = [line.split(",") for line in PLAIN.splitlines()]
    written = [rows[0], *([n, right if k == "1" else wrong] for n, k in rows[1:]), ["", ""]]
    other.write_text(first + "".join(separator.join(row) + "\n" for row in written))
    found = []
    for path in (plain, other):
        assert main(["fit", str(path), "--json"]) == 0
        found.append(capsys.readouterr().out)
    assert found[0] == found[1]


def test_the_minus_of_typesetters_and_columns_of_another_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "t.csv"
    table.write_text("stim,acc,n\n−2,21,40\n−1,24,40\n0,31,40\n1,38,40\n")
    named = ["--columns", "level=stim,correct=acc,total=n"]
    assert main(["fit", str(table), "--json", *named]) == 0
    assert -1 < json.loads(capsys.readouterr().out)["threshold"]["value"] < 1
    assert main(["fit", str(table), "--columns", "level=dose"]) == 2
    assert "--columns: expected a column dose, found stim,acc,n" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("level,correct,correct\n1,1,0\n", "found correct twice"),
        ("Level,level,correct\n1,1,0\n", "found level twice"),
        ("level;correct;total\n1,000;3;4\n", "is 1,000 a thousand (1000) or a decimal comma?"),
        ("level;correct;total\n0,5;3;4\n", "a decimal comma: write 0.5"),
        ('level,correct,total\n"0,5",3,4\n"1,000",3,4\n', "a decimal comma: write 0.5"),
    ],
)
def test_what_is_asked_about(
    text: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "t.csv"
    table.write_text(text)
    assert main(["fit", str(table)]) == 2
    told = capsys.readouterr().err
    assert said in told
    assert "write 1.000" not in told


def test_thousands_are_read_where_commas_separate(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "t.csv"
    table.write_text(
        'level,correct,total\n500,21,40\n"1,000",24,40\n"1,500",35,40\n"2,000",39,40\n'
    )
    assert main(["fit", str(table), "--json"]) == 0
    assert 900 < json.loads(capsys.readouterr().out)["threshold"]["value"] < 1600


@pytest.mark.parametrize(
    ("right", "said"),
    [
        ([184, 190, 194, 198], "below 1, the least level shown: show smaller ones"),
        ([180, 180, 180, 194], "below 1, the least level shown: show smaller ones"),
        ([100, 101, 104, 128], "above 4, the greatest level shown: show greater ones"),
    ],
)
def test_levels_all_easy_or_all_hard_say_where_the_threshold_lies(
    right: list[int], said: str
) -> None:
    found = summarise(counts(LEVELS, right, [200] * 4), setting("logistic", 0.5, 0.02), samples=0)
    assert said in found.verdict
