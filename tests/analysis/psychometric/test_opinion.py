"""The second opinion against known truths: functions, lapse rates fixed and free, guesses."""

import numpy as np
import pytest

from analysis.psychometric import FUNCTIONS, Counts, location_for, proportion, setting
from analysis.psychometric.opinion import second_opinion

SLOPES = {"logistic": 1.6, "cumulative-normal": 1.0, "weibull": 3.0, "gumbel": 0.4}
LEVELS = np.arange(1.0, 9.0)
LAPSE, TRUTH = 0.04, 4.2
RATES = [(lapse, guess) for lapse in (LAPSE, None) for guess in (0.5, 0.25)]
GRID = [(name, *rates) for name in FUNCTIONS for rates in RATES]


def drawn(name: str, guess: float, at: float, seed: int, trials: int = 60) -> Counts:
    location = location_for(name, TRUTH, at, SLOPES[name], guess, LAPSE)
    p = proportion(name, LEVELS, location, SLOPES[name], guess, LAPSE)
    right = np.random.default_rng(seed).binomial(trials, p).astype(float)
    return Counts(LEVELS, right, np.full_like(right, float(trials)))


def held(name: str, lapse: float | None, guess: float, sets: int, seed: int = 0) -> int:
    """In how many sets the interval holds the truth; value and interval must agree in all."""
    pytest.importorskip("psignifit")
    at, found = (0.75 if guess == 0.5 else 0.625), 0
    for number in range(sets):
        data = drawn(name, guess, at, 1000 * seed + number)
        told = second_opinion(data, setting(name, guess, lapse), at)
        assert told is not None
        assert told.low < told.value < told.high
        found += told.low <= TRUTH <= told.high
    return found


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_truth_lies_in_the_interval_of_a_thin_sample(name: str) -> None:
    assert held(name, None, 0.5, 2, seed=3) >= 1


@pytest.mark.slow
@pytest.mark.parametrize(("name", "lapse", "guess"), GRID)
def test_the_truth_lies_in_nine_intervals_of_ten(
    name: str, lapse: float | None, guess: float
) -> None:
    inside = held(name, lapse, guess, 20)
    print(f"\n{name}, lapse {lapse}, guess {guess}: {inside} of 20")
    assert inside >= 18


def test_a_weibull_is_fitted_as_a_weibull() -> None:
    """2,400 answers: another curve than the one that made them is off by far more than chance."""
    pytest.importorskip("psignifit")
    location = location_for("weibull", 3.13, 0.75, 1.2, 0.5, 0.02)
    levels = np.array([0.5, 1.0, 2.0, 4.0, 8.0, 16.0])
    p = proportion("weibull", levels, location, 1.2, 0.5, 0.02)
    right = np.random.default_rng(2).binomial(400, p).astype(float)
    told = second_opinion(
        Counts(levels, right, np.full(6, 400.0)), setting("weibull", 0.5, 0.02), 0.75
    )
    assert told is not None
    assert told.low < 3.13 < told.high
    assert told.value == pytest.approx(3.13, rel=0.08)
