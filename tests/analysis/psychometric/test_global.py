"""Fits against a slow global search: whatever the table, nothing better is found.

The search profiles the likelihood over a fine grid of slopes, lapse rates and centres and polishes
the best of them with a general bounded optimiser; it shares no code with the fit but the function.
"""

import numpy as np
import pytest
from scipy.optimize import minimize

from analysis.psychometric import FUNCTIONS, fit_batch, setting
from analysis.psychometric.fit import SHALLOWEST, Setting, fit, scale_of
from analysis.psychometric.functions import Array
from analysis.psychometric.table import read_counts
from tests.analysis.cases import stat_case

WORSE = 0.01
TABLES = 250  # of one shape at a time


def tables(rng: np.random.Generator) -> tuple[Array, Array, Array, Setting, str]:
    """Tables of one shape: levels, right answers and trials, what is fitted."""
    name = str(rng.choice(list(FUNCTIONS)))
    count = int(rng.integers(2, 9))
    levels = (
        np.sort(rng.uniform(0.5, 8, count)) if rng.random() < 0.5 else np.arange(1.0, count + 1)
    )
    total = np.tile(rng.integers(1, int(rng.choice([3, 12, 60, 200])) + 1, count), (TABLES, 1))
    guess = float(rng.choice([0.0, 0.25, 0.5]))
    lapse = None if rng.random() < 0.5 else float(rng.choice([0.0, 0.02, 0.05]))
    if rng.random() < 0.4:  # no function at all
        p = rng.uniform(guess, 1, (TABLES, count))
    else:
        centre, slope = rng.uniform(0, 9, (TABLES, 1)), rng.lognormal(0, 1, (TABLES, 1))
        p = guess + (0.95 - guess) / (1 + np.exp(-slope * (levels - centre)))
    right = rng.binomial(total, p).astype(float)
    return levels, right, total.astype(float), setting(name, guess, lapse), name


def likelihoods(theta: Array, z: Array, right: Array, total: Array, what: Setting) -> Array:
    """Log likelihoods (S, B) of parameters (S, 3) for tables (B, L)."""
    eta = theta[:, :1] + theta[:, 1:2] * z
    lapse = theta[:, 2:]
    span = 1 - what.guess - lapse
    p = what.guess + span * what.function.cdf(eta)
    q = lapse + span * what.function.survival(eta)
    return (
        np.log(np.maximum(p, 1e-300)) @ right.T + np.log(np.maximum(q, 1e-300)) @ (total - right).T
    )


def globally(levels: Array, right: Array, total: Array, what: Setting) -> Array:
    """The highest log likelihood (B,) of a fine grid: a lower bound of the global maximum."""
    scale = scale_of(levels, what.function)
    slopes = np.geomspace(SHALLOWEST, scale.steepest, 70)
    lapses = np.linspace(0, what.lapse_bound, 11) if what.lapse is None else [what.lapse]
    best = np.full(len(right), -np.inf)
    for b in slopes:
        # Centres so far out that a shallow slope can still bend towards guessing or towards one.
        reach = 1.5 + 6 / b
        centres = np.concatenate([np.linspace(-1.6, 1.6, 81), np.linspace(-reach, reach, 61)])
        theta = np.array([(-b * c, b, lapse) for c in centres for lapse in lapses])
        best = np.maximum(best, likelihoods(theta, scale.z, right, total, what).max(0))
    return best


def polished(levels: Array, right: Array, total: Array, what: Setting) -> float:
    """One table's maximum by a general optimiser from many starts."""
    scale = scale_of(levels, what.function)
    top = what.lapse_bound if what.lapse is None else what.lapse
    bounds = [(-60, 60), (np.log(SHALLOWEST), np.log(scale.steepest)), (what.lapse or 0.0, top)]
    bounds[0] = (-60 - scale.steepest, 60 + scale.steepest)

    def loss(t: Array) -> float:
        theta = np.array([[t[0], np.exp(t[1]), t[2]]])
        return -float(likelihoods(theta, scale.z, right[None], total[None], what)[0, 0])

    starts = [
        np.array([-b * c, np.log(b), np.clip(0.03, bounds[2][0], top)])
        for b in np.geomspace(0.05, scale.steepest, 8)
        for c in np.linspace(-1.2, 1.2, 9)
    ]
    starts.sort(key=loss)
    return max(-minimize(loss, s, method="L-BFGS-B", bounds=bounds).fun for s in starts[:8])


def worse_than_global(shapes: int, seed: int) -> tuple[list[str], int]:
    """Fits that a slow search betters, and how many there were."""
    told = []
    for number in range(shapes):
        levels, right, total, what, name = tables(np.random.default_rng([seed, number]))
        found = fit_batch(levels, right, total, what).value
        best = globally(levels, right, total, what)
        for row in np.flatnonzero(best > found + WORSE):
            told.append(f"{name} {what.guess} {what.lapse} {levels} {right[row]} {total[row]}: "
                        f"{found[row]:.3f}, {best[row]:.3f} exists")  # fmt: skip
        for row in range(0, TABLES, 125):
            best_of_row = polished(levels, right[row], total[row], what)
            if best_of_row > found[row] + WORSE:
                told.append(f"{name} {levels} {right[row]}: {best_of_row:.3f} exists")
    return told, shapes * TABLES


def test_nothing_better_exists_in_a_thin_sample() -> None:
    told, _ = worse_than_global(4, 1)
    assert told == []


@pytest.mark.slow
def test_nothing_better_exists_in_a_hundred_thousand_tables() -> None:
    told, count = worse_than_global(400, 2)
    print(f"\n{len(told)} of {count} fits are worse by {WORSE}", *told[:20], sep="\n")
    assert len(told) <= count / 10_000


def test_two_maxima_along_the_slope() -> None:
    data = read_counts(stat_case("ecc2.csv"))
    found = fit(data, setting("gumbel", 0.25, 0.02))
    assert float(found.value[0]) >= -341.415
