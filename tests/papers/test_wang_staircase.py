"""Wang 2005, VI.2.1: where his staircase and Levitt's settle, from their exact chains."""

import numpy as np
import pytest
from scipy.stats import norm

from study.trials.chain import stationary
from study.trials.rules import rule_levitt, rule_wang

# Step in SDs: proportion right at the mean level, and overall.
FIGURES = {
    "wang": (rule_wang(), {0.1: (0.7025, 0.7067), 0.25: (0.6930, 0.7063), 0.5: (0.672, 0.7059)}),
    "levitt": (
        rule_levitt(2, 1),
        {0.1: (0.7046, 0.7067), 0.25: (0.7001, 0.7062), 0.5: (0.6905, 0.7054)},
    ),
}


@pytest.mark.parametrize("name", FIGURES)
@pytest.mark.parametrize("step", [0.1, 0.25, 0.5])
def test_exact_targets_on_a_cumulative_normal(name: str, step: float) -> None:
    rule, figures = FIGURES[name]
    count = round(6 / step)
    levels = np.arange(-count, count + 1) * step
    long_run = stationary(rule, levels, 0.5 + 0.5 * norm.cdf(levels))
    at_mean, overall = figures[step]
    assert 0.5 + 0.5 * norm.cdf(long_run.mean_level) == pytest.approx(at_mean, abs=1e-3)
    assert long_run.overall_correct == pytest.approx(overall, abs=1e-3)


def test_the_chain_agrees_with_a_simulation() -> None:
    levels = np.arange(-12, 13) * 0.5
    correct = 0.5 + 0.5 * norm.cdf(levels)
    rule = rule_wang()
    generator = np.random.default_rng(5)
    place, state, seen = 12, rule.begin(tuple(range(25)), 12), np.zeros(len(levels))
    for _ in range(40_000):
        seen[place] += 1
        state, move = rule.step(state, bool(generator.random() < correct[place]))
        place = int(np.clip(place + move, 0, len(levels) - 1))
    occupancy = stationary(rule, levels, correct).occupancy
    np.testing.assert_allclose(seen / seen.sum(), occupancy, atol=0.02)
