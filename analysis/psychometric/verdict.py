"""Whether the data carry a threshold at all.

Maximum likelihood prints a threshold for any table; these rules say when it is no more than a
number. Their two errors are held by simulation: of chance data at most 5 % get a number, and of
good data (threshold inside the levels, 40 trials a level) at most 5 % are refused.
"""

import numpy as np
from scipy.special import chdtrc

from analysis.psychometric.fit import SHALLOWEST, Batch, fit_batch, fit_steepest
from analysis.psychometric.functions import Array
from analysis.psychometric.profile import threshold_interval
from analysis.psychometric.scoring import log_likelihood

CONSTANT_P = 0.05  # a likelihood ratio against a constant must have a smaller p
CONSTANT_DF = {1: 0.5, 2: 0.5}  # degrees of freedom of that ratio, with their shares
RIDGE = 1e-3  # log likelihood: a step that loses no more than this fits as well as the best slope
INTERVAL = 0.95  # the profile interval that must be bounded

OK = "ok"
REASONS = (
    OK,
    "the levels make no difference (likelihood ratio against a constant: p > {p:g})",
    "the proportion right falls with the level",
    "the slope is at its bound (a step or a flat line fits as well)",
    "the threshold lies outside the levels shown",
    "the {interval:.0%} profile interval of the threshold is unbounded",
)


def constant_p(value: Array, correct: Array, total: Array) -> Array:
    """p (B,) of the likelihood ratio of fits, of log likelihood `value` (B,), against a constant.

    The slope is one degree of freedom, but a constant leaves the location undefined, and the search
    over locations finds more of chance than that (Davies 1977). The p is the mean of those of one
    and of two degrees of freedom: by simulation with one, up to 7 % of sparse chance tables would
    get a number, with this mixture at most 3.5 %, and it keeps more power than two.
    """
    trials = total.sum(-1)
    mean = (correct.sum(-1) / trials)[:, None]
    level = log_likelihood(mean, 1 - mean, correct, total)
    ratio = np.maximum(2 * (value - level), 0.0)
    return sum(share * chdtrc(df, ratio) for df, share in CONSTANT_DF.items())


def judge(
    levels: Array, fits: Batch, correct: Array, total: Array, at: float
) -> tuple[Array, Array, Array]:
    """Index into REASONS (B,) and the two ends (B,) of the profile interval of the threshold."""
    verdict = np.zeros(len(fits.a), int)
    falling = fit_batch(levels, correct, total, fits.setting, falling=True)
    best = np.maximum(fits.value, falling.value)
    flat = constant_p(best, correct, total) > CONSTANT_P
    threshold = fits.threshold(at)
    # Where a step is the limit, the likelihood climbs towards it on a ridge so flat that the search
    # stops anywhere along it: what counts is what the steepest slope loses, not where it stopped.
    step = fit_steepest(fits, correct, total).value > fits.value - RIDGE
    at_bound = step | (fits.b <= SHALLOWEST * 1.001)
    shown = total > 0
    lowest = levels[shown.argmax(1)]
    highest = levels[len(levels) - 1 - shown[:, ::-1].argmax(1)]
    outside = ~((threshold >= lowest) & (threshold <= highest))
    faults = (flat, falling.value > fits.value, at_bound, outside)
    low, high = threshold_interval(fits, correct, total, at, INTERVAL)
    unbounded = ~(np.isfinite(low) & np.isfinite(high) & (_above_zero(low, fits)))
    for reason, fault in reversed(list(enumerate((*faults, unbounded), start=1))):
        verdict[fault] = reason
    return verdict, low, high


def _above_zero(low: Array, fits: Batch) -> Array:
    """On a logarithmic scale an end at 0 is as unbounded as one at infinity."""
    return np.isfinite(fits.setting.function.transform(low))


def sentence(verdict: int) -> str:
    """The verdict as `segue fit` prints it: "ok" or "not identifiable: why"."""
    if verdict == 0:
        return OK
    return "not identifiable: " + REASONS[verdict].format(p=CONSTANT_P, interval=INTERVAL)
