"""Whether the data carry a threshold at all.

Maximum likelihood prints a threshold for any table; these rules say when it is no more than a
number. Their two errors are held by simulation: of chance data at most 5 % get a number, and of
good data (threshold inside the levels, 40 trials a level) at most 5 % are refused.
"""

from dataclasses import replace

import numpy as np
from scipy.special import betainc, chdtrc

from analysis.psychometric.fit import SHALLOWEST, Batch, Setting, fit_batch, fit_steepest
from analysis.psychometric.functions import Array
from analysis.psychometric.profile import threshold_interval
from analysis.psychometric.scoring import ROUGH, log_likelihood

CONSTANT_P = 0.05  # a likelihood ratio against a constant must have a smaller p
CONSTANT_DF = {1: 0.5, 2: 0.5}  # degrees of freedom of that ratio, with their shares
RIDGE = 1e-3  # log likelihood: a step that loses no more than this fits as well as the best slope
INTERVAL = 0.95  # the profile interval that must be bounded

OK = "ok"
REASONS = (
    OK,
    "only one level was shown: show more",
    "every answer is right: the threshold lies below {least:g}, the least level shown: show "
    "smaller ones",
    "nearly every answer is right at every level: the threshold lies below {least:g}, the least "
    "level shown: show smaller ones",
    "fewer right than by guessing ({right:g} of {trials:g} at a guess rate of {guess:g}, {p}): are "
    "the keys the wrong way round?",
    "the levels make no difference (likelihood ratio against a constant: p > {flat:g})",
    "the proportion right falls with the level",
    "the lapse rate is at its bound of {bound:g}: people miss for other reasons than the level, or "
    "the bound is too low",
    "the threshold lies below {least:g}, the least level shown: show smaller ones",
    "the threshold lies above {most:g}, the greatest level shown: show greater ones",
    "the slope is at its bound (a step or a flat line fits as well)",
    "the threshold lies outside the levels shown",
    "the {interval:.0%} profile interval of the threshold is unbounded",
)
BELOW_P = (
    1e-3  # of a binomial test of fewer right answers than by guessing, or than the threshold's
)
WIDE = 0.8  # of what the guess rate leaves: the bound that a lapse rate at its own is tried with
BETTER = 0.5  # log likelihood by which the wider bound must fit better
AT_BOUND = 1e-4  # a free lapse rate as close to its bound is at it


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
    falling = fit_batch(levels, correct, total, fits.setting, falling=True, tolerance=ROUGH)
    best = np.maximum(fits.value, falling.value)
    flat = constant_p(best, correct, total) > CONSTANT_P
    threshold = fits.threshold(at)
    # Where a step is the limit, the likelihood climbs towards it on a ridge so flat that the search
    # stops anywhere along it: what counts is what the steepest slope loses, not where it stopped.
    step = fit_steepest(fits, correct, total).value > fits.value - RIDGE
    at_bound = step | (fits.b <= SHALLOWEST * 1.001)
    shown = total > 0
    right, trials = correct.sum(1), total.sum(1)
    one = shown.sum(1) == 1
    perfect = right == trials
    above = flat & (1 - _at_most(right - 1, trials, at) < BELOW_P)
    guess = fits.setting.guess
    below = _at_most(right, trials, guess) < BELOW_P
    lapses = _bound_too_low(levels, fits, correct, total)
    least, most = shown.argmax(1), len(levels) - 1 - shown[:, ::-1].argmax(1)
    outside = ~((threshold >= levels[least]) & (threshold <= levels[most]))
    falls = falling.value > fits.value
    table = np.arange(len(total))
    easy = 1 - _at_most(correct[table, least] - 1, total[table, least], at) < BELOW_P
    hard = _at_most(correct[table, most], total[table, most], at) < BELOW_P
    easy, hard = easy & (at_bound | outside), hard & (at_bound | outside)
    faults = (one, perfect, above, below, flat, falls, lapses, easy, hard, at_bound, outside)
    low, high = threshold_interval(fits, correct, total, at, INTERVAL)
    unbounded = ~(np.isfinite(low) & np.isfinite(high) & (_above_zero(low, fits)))
    for reason, fault in reversed(list(enumerate((*faults, unbounded), start=1))):
        verdict[fault] = reason
    return verdict, low, high


def at_lapse_bound(fits: Batch) -> Array:
    """Whether each free lapse rate (B,) ended at its bound."""
    if fits.setting.lapse is not None:
        return np.zeros(len(fits.a), bool)
    return fits.lapse >= fits.setting.lapse_bound - AT_BOUND


def _bound_too_low(levels: Array, fits: Batch, correct: Array, total: Array) -> Array:
    """Whether a wider bound fits better (B,): the threshold of such a fit is pushed aside.

    Where it does not, the fit stands: the profile interval lets the lapse rate go beyond the bound.
    """
    found = at_lapse_bound(fits)
    if found.any():
        wide = replace(fits.setting, lapse_bound=WIDE * (1 - fits.setting.guess))
        again = fit_batch(levels, correct[found], total[found], wide, tolerance=ROUGH)
        found[found] = again.value > fits.value[found] + BETTER
    return found


def _at_most(right: Array, trials: Array, p: float) -> Array:
    """Probability of at most so many right answers in so many trials."""
    with np.errstate(invalid="ignore"):
        below = betainc(trials - right, right + 1, 1 - p)
    return np.where(right < 0, 0.0, np.where(right >= trials, 1.0, below))


def _above_zero(low: Array, fits: Batch) -> Array:
    """On a logarithmic scale an end at 0 is as unbounded as one at infinity."""
    return np.isfinite(fits.setting.function.transform(low))


def verdict_words(verdict: int, what: Setting, levels: Array, correct: Array, total: Array) -> str:
    """The verdict on one table (L,) as `segue fit` prints it: "ok" or "not identifiable: why"."""
    if verdict == 0:
        return OK
    right, trials = float(correct.sum()), float(total.sum())
    p = float(_at_most(np.array(right), np.array(trials), what.guess))
    return "not identifiable: " + REASONS[verdict].format(
        least=levels[total > 0].min(),
        most=levels[total > 0].max(),
        right=right,
        trials=trials,
        guess=what.guess,
        p=f"p < 1e{int(np.ceil(np.log10(max(p, 1e-300))))}",
        flat=CONSTANT_P,
        bound=what.lapse_bound,
        interval=INTERVAL,
    )
