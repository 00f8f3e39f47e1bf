"""Other fits of the same trials: known truths recovered, and what must agree."""

import numpy as np
import pytest

from analysis.errors import InputError
from analysis.psychometric import (
    FUNCTIONS,
    PeopleCounts,
    counts,
    fit,
    location_for,
    people_counts,
    proportion,
    setting,
    summarise,
)
from analysis.psychometric.compare import pool, same_function
from analysis.psychometric.dprime import DECISION_RULES, d_prime_of, proportion_of
from analysis.psychometric.opinion import second_opinion
from analysis.psychometric.profile import profile_threshold, slope_interval
from analysis.psychometric.random import fit_random_threshold
from analysis.psychometric.reduced import fit_reduced

SLOPES = {"logistic": 1.6, "cumulative-normal": 1.0, "weibull": 3.0, "gumbel": 0.4}


def people(function: str, mean: float, spread: float, seed: int = 0) -> PeopleCounts:
    rng = np.random.default_rng(seed)
    own = mean + spread * rng.standard_normal(12)
    location = location_for(function, own, 0.75, SLOPES[function], 0.5, 0.02)
    levels = np.tile(np.repeat(np.arange(1.0, 9.0), 10), 12)
    who = np.repeat(np.arange(12), 80)
    p = proportion(function, levels, location[who], SLOPES[function], 0.5, 0.02)
    return people_counts(who, levels, rng.random(len(levels)) < p)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_random_threshold_finds_the_mean_and_the_spread(name: str) -> None:
    found = fit_random_threshold(people(name, 4.5, 0.8), setting(name, 0.5, 0.02))
    assert found.low < 4.5 < found.high
    # The Weibull function's spread is on the logarithm of the level.
    assert found.sd == pytest.approx(0.8 / 4.5 if name == "weibull" else 0.8, rel=0.6)


def test_random_threshold_without_spread_is_the_pooled_fit() -> None:
    data = people("logistic", 4.5, 0.0, seed=1)
    what = setting("logistic", 0.5, 0.02)
    pooled = fit(data.pooled(), what)
    found = fit_random_threshold(data, what)
    assert found.value == pytest.approx(float(pooled.threshold(0.75)[0]), abs=0.1)
    assert found.log_likelihood >= float(pooled.value[0]) - 0.05


def test_profile_ends_are_where_the_likelihood_ratio_reaches_its_quantile() -> None:
    data = counts([1, 2, 3, 4, 5, 6, 7], [21, 22, 25, 31, 36, 39, 40], [40] * 7)
    what = setting("logistic")
    fits = fit(data, what)
    threshold = summarise(data, what, samples=0).thresholds[0]
    for end in (threshold.low, threshold.high):
        z = (end - fits.scale.centre) / fits.scale.half
        at_end = profile_threshold(fits, np.array([z]), data.correct[None], data.total[None], 0.75)
        assert 2 * (fits.value[0] - at_end[0]) == pytest.approx(3.8415, abs=2e-3)


def test_the_slope_interval_holds_the_slope() -> None:
    data = counts([1, 2, 3, 4, 5, 6, 7], [21, 22, 25, 31, 36, 39, 40], [40] * 7)
    fits = fit(data, setting("logistic", 0.5, 0.0))
    low, high = slope_interval(fits, data.correct[None], data.total[None])
    assert 0 < low[0] < fits.slope[0] < high[0] < 20


def test_bias_reduction_flattens_and_stays_finite_on_a_step() -> None:
    what = setting("logistic", 0.5, 0.0)
    plain = counts([1, 2, 3, 4, 5], [5, 6, 8, 10, 10], [10] * 5)
    assert fit_reduced(plain, what).slope < float(fit(plain, what).slope[0])
    step = counts([1, 2, 3, 4], [5, 5, 10, 10], [10] * 4)
    assert fit_reduced(step, what).slope < 0.5 * float(fit(step, what).slope[0])


def test_bias_reduction_takes_bias_out_of_few_trials() -> None:
    rng = np.random.default_rng(5)
    levels, what = np.arange(1.0, 8.0), setting("logistic", 0.5, 0.0)
    slopes = []
    for _ in range(60):
        right = rng.binomial(20, proportion("logistic", levels, 4.0, 1.0))
        data = counts(levels, right, np.full(7, 20))
        slopes.append((float(fit(data, what).slope[0]), fit_reduced(data, what).slope))
    plain, reduced = np.mean(slopes, 0) - 1.0
    assert abs(reduced) < abs(plain)


def test_same_function_accepts_and_rejects() -> None:
    rng = np.random.default_rng(2)
    levels = np.arange(1.0, 9.0)

    def drawn(location: float) -> object:
        right = rng.binomial(40, proportion("logistic", levels, location, 1.0))
        return counts(levels, right, np.full(8, 40))

    what = setting("logistic", 0.5, 0.0)
    one, alike, other = drawn(4.0), drawn(4.0), drawn(6.0)
    assert same_function([one, alike], what).p > 0.01
    assert same_function([one, other], what).p < 1e-6
    assert same_function([one, alike, other], what).df == 4
    assert pool([one, other]).trials == 640


def test_p_of_same_function_is_even_under_the_null() -> None:
    rng = np.random.default_rng(7)
    levels, what = np.arange(1.0, 9.0), setting("logistic", 0.5, 0.0)
    p = proportion("logistic", levels, 4.5, 1.0)
    sets = [
        same_function(
            [counts(levels, rng.binomial(30, p), np.full(8, 30)) for _ in range(2)], what
        ).p
        for _ in range(150)
    ]
    assert 0.01 <= np.mean(np.array(sets) < 0.05) <= 0.11


@pytest.mark.parametrize("rule", DECISION_RULES)
def test_d_prime_and_back(rule: str) -> None:
    for d_prime in (0.3, 1.0, 2.5):
        assert d_prime_of(proportion_of(d_prime, rule), rule) == pytest.approx(d_prime)


def test_d_prime_of_tables() -> None:
    """2AFC: d′ = 0.95 at .75 (Macmillan and Creelman 2005, table A5.2); the dual-pair rule by
    simulating the two differences."""
    assert d_prime_of(0.75) == pytest.approx(0.954, abs=5e-4)
    rng = np.random.default_rng(0)
    clips = rng.standard_normal((4, 400_000))
    clips[0] += 2.1
    larger = np.abs(clips[0] - clips[1]) > np.abs(clips[2] - clips[3])
    assert proportion_of(2.1, "dual-pair") == pytest.approx(larger.mean(), abs=3e-3)
    with pytest.raises(InputError, match="d′"):
        proportion_of(-1)
    with pytest.raises(InputError, match="proportion right"):
        d_prime_of(0.4)


def test_a_second_opinion_agrees_where_there_is_one() -> None:
    pytest.importorskip("psignifit")
    data, what = people("logistic", 4.5, 0.0).pooled(), setting("logistic", 0.5, 0.02)
    told = second_opinion(data, what, 0.75)
    assert told is not None
    assert told.value == pytest.approx(
        summarise(data, what, samples=0).thresholds[0].value, rel=0.05
    )
