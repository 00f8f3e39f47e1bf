"""Fits against published ones, their verdicts, and known truths recovered."""

import numpy as np
import pytest

from analysis.errors import InputError
from analysis.psychometric import FUNCTIONS, counts, people_counts, setting, summarise

PALAMEDES = counts([0.01, 0.03, 0.05, 0.07, 0.09, 0.11], [59, 53, 68, 83, 92, 99], [100] * 6)


@pytest.mark.parametrize(
    ("lapse", "location", "slope", "log_likelihood", "deviance"),
    [(0.0, 0.060126, 63.90, -280.3118, 3.477), (0.02, 0.058401, 71.01, -281.0842, 5.022)],
)
def test_the_demo_of_palamedes(
    lapse: float, location: float, slope: float, log_likelihood: float, deviance: float
) -> None:
    found = summarise(PALAMEDES, setting("logistic", 0.5, lapse), samples=0)
    assert found.location == pytest.approx(location, abs=5e-7)
    assert found.slope == pytest.approx(slope, abs=5e-3)
    assert found.log_likelihood == pytest.approx(log_likelihood, abs=5e-5)
    assert found.deviance == pytest.approx(deviance, abs=5e-4)
    assert found.verdict == "ok"


def test_the_demo_of_psignifit() -> None:
    levels = [*np.arange(0.001, 0.00501, 0.0005), 0.006, 0.007, 0.008, 0.010]
    right = [45, 50, 44, 44, 52, 53, 62, 64, 76, 79, 88, 90, 90]
    found = summarise(counts(levels, right, [90] * 13), setting("cumulative-normal"), samples=0)
    assert found.location == pytest.approx(0.00464, rel=0.01)


def test_a_table_that_others_print_a_threshold_for_is_denied() -> None:
    found = summarise(counts([1, 2, 3, 4], [5, 6, 4, 5], [10] * 4), setting("logistic"))
    told = found.as_dict()
    assert told["verdict"].startswith("not identifiable: ")
    assert told["threshold"] == {"at": 0.75, "value": None, "low": None, "high": None}
    assert told["location"] is None


@pytest.mark.parametrize(
    ("right", "why"),
    [
        ([39, 35, 30, 22], "falls"),
        ([20, 20, 40, 40], "bound"),
        ([36, 37, 39, 40], "outside|constant"),
        ([20, 21, 22, 27], "outside|constant"),
    ],
)
def test_reasons(right: list[int], why: str) -> None:
    found = summarise(counts([1, 2, 3, 4], right, [40] * 4), setting("logistic", 0.5, 0.0))
    assert found.verdict.startswith("not identifiable: ")
    assert any(part in found.verdict for part in why.split("|"))


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("interval", ["profile", "parametric", "trials"])
def test_every_interval_holds_a_plain_threshold(name: str, interval: str) -> None:
    data = counts([1, 2, 3, 4, 5, 6, 7], [21, 22, 25, 31, 36, 39, 40], [40] * 7)
    found = summarise(data, setting(name), interval=interval, samples=300)
    threshold = found.thresholds[0]
    assert threshold.low < threshold.value < threshold.high
    assert 3 < threshold.low < threshold.high < 5
    assert found.deviance_p is not None
    assert found.deviance_p > 0.05


def test_people_who_differ_widen_the_pooled_interval() -> None:
    rng = np.random.default_rng(4)
    levels = np.tile(np.repeat(np.arange(1.0, 9.0), 10), 12)
    people = np.repeat(np.arange(12), 80)
    own = rng.normal(4.5, 1.2, 12)[people]
    correct = rng.random(len(levels)) < 0.5 + 0.5 / (1 + np.exp(-2 * (levels - own)))
    data = people_counts(people, levels, correct)
    widths = {}
    for interval in ("trials", "people"):
        found = summarise(data, setting("logistic"), interval=interval, samples=500)
        widths[interval] = found.thresholds[0].high - found.thresholds[0].low
    assert widths["people"] > 1.5 * widths["trials"]


@pytest.mark.parametrize(
    ("levels", "right", "total", "message"),
    [
        ([1, 2], [3], [4, 4], "equal length"),
        ([1, 2], [5, 1], [4, 4], "row 1: expected whole counts"),
        ([1, np.nan], [1, 1], [4, 4], "finite"),
        ([], [], [], "at least one trial"),
    ],
)
def test_bad_tables_are_refused(levels: list, right: list, total: list, message: str) -> None:
    with pytest.raises(InputError, match=message):
        counts(levels, right, total)


def test_weibull_refuses_level_zero() -> None:
    with pytest.raises(InputError, match="above 0"):
        summarise(counts([0, 1, 2], [5, 7, 9], [10] * 3), setting("weibull"))
