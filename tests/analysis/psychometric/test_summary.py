"""Fits against published ones, their verdicts, and known truths recovered."""

import numpy as np
import pytest

from analysis.errors import InputError
from analysis.psychometric import FUNCTIONS, counts, fit_batch, people_counts, setting, summarise
from analysis.psychometric.fit import fit_steepest

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
        ([36, 37, 39, 40], "the threshold lies|constant"),
        ([20, 21, 22, 27], "the threshold lies|constant"),
    ],
)
def test_reasons(right: list[int], why: str) -> None:
    found = summarise(counts([1, 2, 3, 4], right, [40] * 4), setting("logistic", 0.5, 0.0))
    assert found.verdict.startswith("not identifiable: ")
    assert any(part in found.verdict for part in why.split("|"))


@pytest.mark.parametrize("lapse", [0.0, 0.0098, 0.05, None])
def test_a_slope_on_the_ridge_to_a_step_is_at_its_bound(lapse: float | None) -> None:
    """The likelihood is level from a slope of about 6 on; where the search stops says nothing."""
    data = counts([1, 3, 6], [0, 10, 32], [2, 23, 35])
    found = summarise(data, setting("logistic", 0.5, lapse), samples=0)
    assert "slope is at its bound" in found.verdict
    assert found.as_dict()["slope"] is None


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("lapse", [0.02, None])
def test_the_steepest_fit_finds_the_step(name: str, lapse: float | None) -> None:
    """With levels far apart the best step is known: guessing, one level free, then lapses."""
    levels, total = np.array([1.0, 2.0, 4.0, 8.0]), np.full((1, 4), 40.0)
    for correct in ([[20, 33, 38, 37]], [[20, 20, 38, 38]], [[21, 19, 27, 38]]):
        right = np.array(correct, float)
        fits = fit_batch(levels, right, total, setting(name, 0.5, lapse))
        found = fit_steepest(fits, right, total).value[0]
        best = max(step_likelihood(right[0], total[0], free, lapse) for free in range(4))
        assert best - 2e-3 < found < max(best, fits.value[0]) + 2e-3


def step_likelihood(right: np.ndarray, total: np.ndarray, free: int, lapse: float | None) -> float:
    def of(rate: float) -> float:
        p = np.where(np.arange(len(right)) < free, 0.5, 1 - rate)
        p[free] = np.clip(right[free] / total[free], 0.5, 1 - rate)
        return float((right * np.log(p) + (total - right) * np.log1p(-p)).sum())

    return max(of(rate) for rate in (np.linspace(1e-6, 0.1, 2001) if lapse is None else [lapse]))


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
