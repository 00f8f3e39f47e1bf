"""The errors of intervals and verdicts, by simulation.

`make test` runs few sets with a binomial tolerance; the slow tests run a thousand for each
function and print every figure (`make certify-statistics`).
"""

import numpy as np
import pytest

from analysis.psychometric import FUNCTIONS, fit_batch, location_for, proportion, setting
from analysis.psychometric.functions import Array
from analysis.psychometric.profile import slope_interval, threshold_interval
from analysis.psychometric.verdict import judge

LEVELS = np.arange(1.0, 8.0)
TRIALS = 40.0
LAPSE = 0.02
AT = 0.75
SLOPES = {"logistic": 1.2, "cumulative-normal": 0.8, "weibull": 3.5, "gumbel": 0.35}


def drawn(name: str, sets: int, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Counts of `sets` tables whose thresholds lie well inside the levels, and the truths."""
    truth = rng.uniform(2.5, 5.5, sets)
    location = location_for(name, truth, AT, SLOPES[name], 0.5, LAPSE)
    p = proportion(name, LEVELS, location[:, None], SLOPES[name], 0.5, LAPSE)
    right = rng.binomial(int(TRIALS), p).astype(float)
    return right, np.full_like(right, TRIALS), truth


def profile_coverage(name: str, sets: int, seed: int) -> float:
    right, total, truth = drawn(name, sets, np.random.default_rng(seed))
    fits = fit_batch(LEVELS, right, total, setting(name, 0.5, LAPSE))
    low, high = threshold_interval(fits, right, total, AT)
    return float(((low <= truth) & (truth <= high)).mean())


def bootstrap_coverage(name: str, sets: int, seed: int, samples: int = 400) -> float:
    rng = np.random.default_rng(seed)
    right, total, truth = drawn(name, sets, rng)
    what = setting(name, 0.5, LAPSE)
    fits = fit_batch(LEVELS, right, total, what)
    p = 0.5 + 0.48 * what.function.cdf(fits.a[:, None] + fits.b[:, None] * fits.scale.z)
    held = []
    for each, threshold in zip(p, truth, strict=True):
        again = rng.binomial(int(TRIALS), each, (samples, len(LEVELS))).astype(float)
        values = fit_batch(LEVELS, again, np.full_like(again, TRIALS), what).threshold(AT)
        low, high = np.quantile(values, [0.025, 0.975], method="inverted_cdf")
        held.append(low <= threshold <= high)
    return float(np.mean(held))


def slope_coverage(name: str, sets: int, seed: int) -> float:
    right, total, _ = drawn(name, sets, np.random.default_rng(seed))
    fits = fit_batch(LEVELS, right, total, setting(name, 0.5, LAPSE))
    low, high = slope_interval(fits, right, total)
    return float(((low <= SLOPES[name]) & (SLOPES[name] <= high)).mean())


def chance_given_a_number(name: str, sets: int, levels: int, trials: int, seed: int) -> float:
    right = np.random.default_rng(seed).binomial(trials, 0.5, (sets, levels)).astype(float)
    total, x = np.full_like(right, trials), np.arange(1.0, levels + 1)
    fits = fit_batch(x, right, total, setting(name))
    return float((judge(x, fits, right, total, AT)[0] == 0).mean())


def good_refused(name: str, sets: int, lapse: float | None, seed: int) -> float:
    right, total, _ = drawn(name, sets, np.random.default_rng(seed))
    fits = fit_batch(LEVELS, right, total, setting(name, 0.5, lapse))
    return float((judge(LEVELS, fits, right, total, AT)[0] != 0).mean())


@pytest.mark.parametrize("name", FUNCTIONS)
def test_profile_intervals_cover(name: str) -> None:
    """200 sets at .95: three binomial standard errors are .046."""
    assert 0.95 - 0.046 <= profile_coverage(name, 200, 1) <= 0.95 + 0.046


@pytest.mark.parametrize("name", FUNCTIONS)
def test_verdicts_err_rarely(name: str) -> None:
    assert chance_given_a_number(name, 200, 4, 10, 2) <= 0.05
    assert good_refused(name, 200, None, 3) <= 0.05 + 0.046


@pytest.mark.slow
@pytest.mark.parametrize("name", FUNCTIONS)
def test_certify_profile_coverage(name: str) -> None:
    threshold = profile_coverage(name, 1000, 11)
    slope = slope_coverage(name, 1000, 12)
    bootstrap = bootstrap_coverage(name, 1000, 13)
    print(
        f"\n{name}: coverage of the 95% profile interval of the .75 threshold {threshold:.3f}, "
        f"of its parametric bootstrap {bootstrap:.3f}, of the profile interval of the slope "
        f"{slope:.3f}"
    )
    assert 0.93 <= threshold <= 0.97


@pytest.mark.slow
@pytest.mark.parametrize("name", FUNCTIONS)
def test_certify_verdicts(name: str) -> None:
    chance = {
        f"{levels} × {trials}": chance_given_a_number(name, 1000, levels, trials, 21)
        for levels, trials in ((4, 10), (7, 40), (10, 20), (8, 4))
    }
    good = {str(lapse): good_refused(name, 1000, lapse, 22) for lapse in (None, LAPSE)}
    print(f"\n{name}: chance tables given a number {chance}, good tables refused {good}")
    assert max(chance.values()) <= 0.05
    assert max(good.values()) <= 0.05
