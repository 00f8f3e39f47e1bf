"""Profile-likelihood intervals of the threshold and of the slope, for many fits at once.

The quantity is held at a trial value while the likelihood is maximised over the rest; the
interval is where that maximum stays within half a χ² quantile of the best (Wilks 1938). The two
ends of every row are bracketed outward from the estimate and then closed in on, all in one batch.
"""

from collections.abc import Callable

import numpy as np
from scipy.special import chdtri

from analysis.psychometric.fit import (
    SHALLOWEST,
    Batch,
    Setting,
    curve,
)
from analysis.psychometric.functions import Array
from analysis.psychometric.scoring import log_likelihood, maximise

_FARTHEST = 12.8  # an end farther than this many half ranges from the estimate is unbounded
_NEAREST = 0.05
_STEPS = 9
_CLOSE = 1e-6  # gain in log likelihood that a step must promise: the floor is at 1.92
_START_SLOPES = 12
_START_LAPSES = (0.0, 0.03, 0.12)


def threshold_interval(
    fits: Batch, correct: Array, total: Array, at: float, level: float = 0.95
) -> tuple[Array, Array]:
    """Ends (B,) of the profile interval of the threshold at proportion `at`, ±inf if unbounded."""
    what, scale = fits.setting, fits.scale
    estimate = (_eta(what, at, fits.lapse) - fits.a) / fits.b

    def value(z0: Array, rows: Array) -> Array:
        return profile_threshold(fits, z0, correct[rows], total[rows], at)

    low, high = _ends(value, estimate, fits.value, level)
    restore = what.function.untransform
    with np.errstate(over="ignore"):
        return restore(scale.centre + scale.half * low), restore(scale.centre + scale.half * high)


def slope_interval(
    fits: Batch, correct: Array, total: Array, level: float = 0.95
) -> tuple[Array, Array]:
    """Ends (B,) of the profile interval of the slope; 0 and inf where unbounded."""

    def value(log_b: Array, rows: Array) -> Array:
        return _profile_slope(fits, np.exp(log_b), correct[rows], total[rows])

    low, high = _ends(value, np.log(fits.b), fits.value, level)
    unit = fits.scale.half * fits.setting.function.scale
    return np.exp(low) / unit, np.exp(high) / unit


def profile_threshold(fits: Batch, z0: Array, correct: Array, total: Array, at: float) -> Array:
    """Highest log likelihood (B,) of rising functions whose threshold is at z0 (B,)."""
    what, z = fits.setting, fits.scale.z

    def expand(theta: Array, which: Array) -> Array:
        b = theta[:, 0]
        lapse = theta[:, 1] if what.lapse is None else np.full(len(b), what.lapse)
        return np.stack([_eta(what, at, lapse) - b * z0[which], b, lapse], 1)

    def model(theta: Array, which: Array) -> tuple[Array, Array, Array]:
        full = expand(theta, which)
        p, q, jacobian = curve(z, full[:, : 2 + (what.lapse is None)], what)
        by_a, by_b = jacobian[:, 0], jacobian[:, 1]
        parts = [by_b - z0[which][:, None] * by_a]
        if what.lapse is None:
            moved = _eta(what, at, full[:, 2] + 1e-6) - _eta(what, at, full[:, 2] - 1e-6)
            parts.append(jacobian[:, 2] + by_a * (moved / 2e-6)[:, None])
        return p, q, np.stack(parts, 1)

    lower = np.array([SHALLOWEST, 0.0])
    upper = np.array([fits.scale.steepest, 1 - at - 1e-4])  # whatever bound the fit keeps to
    slopes = np.geomspace(0.2, fits.scale.steepest, _START_SLOPES)
    return _best(model, slopes, lower, upper, what, correct, total)


def _profile_slope(fits: Batch, b: Array, correct: Array, total: Array) -> Array:
    """Highest log likelihood (B,) of functions with slopes b (B,) of η by z."""
    what, z = fits.setting, fits.scale.z

    def model(theta: Array, which: Array) -> tuple[Array, Array, Array]:
        full = np.insert(theta, 1, b[which], axis=1)
        full[:, 0] *= -b[which]
        p, q, jacobian = curve(z, full, what)
        jacobian = np.delete(jacobian, 1, axis=1)
        jacobian[:, 0] *= -b[which][:, None]
        return p, q, jacobian

    lower, upper = np.array([-np.inf, 0.0]), np.array([np.inf, what.lapse_bound])
    return _best(model, np.linspace(-2, 2, 21), lower, upper, what, correct, total)


def _best(
    model: Callable[[Array, Array], tuple[Array, Array, Array]],
    grid: Array, lower: Array, upper: Array, what: Setting, correct: Array, total: Array,
) -> Array:  # fmt: skip
    """Maximise over the first parameter, from the best of `grid`, and a free lapse rate."""
    count, size = len(correct), 1 + (what.lapse is None)
    lapses = [rate for rate in _START_LAPSES if rate < upper[1]] if size == 2 else [0.0]
    starts = np.array([(first, lapse) for first in grid for lapse in lapses or [0.0]])[:, :size]
    rows = np.repeat(np.arange(count), len(starts))
    p, q, _ = model(np.tile(starts, (count, 1)), rows)
    value = log_likelihood(p, q, correct[rows], total[rows]).reshape(count, len(starts))
    start = starts[value.argmax(1)]
    return maximise(model, start, lower[:size], upper[:size], correct, total, _CLOSE)[1]


def _ends(
    value: Callable[[Array, Array], Array], estimate: Array, best: Array, level: float
) -> tuple[Array, Array]:
    """Where `value` falls by half the χ² quantile below `best`, on both sides of `estimate`.

    The signed root of the likelihood ratio is nearly straight, so false position on it (with
    Illinois' halving) needs few steps.
    """
    rows = np.tile(np.arange(len(estimate)), 2)
    sign = np.repeat([-1.0, 1.0], len(estimate))
    centre, top = estimate[rows], best[rows]
    root = np.sqrt(chdtri(1, 1 - level))

    def excess(offset: Array, which: Array) -> Array:
        found = value(centre[which] + sign[which] * offset, rows[which])
        return np.sqrt(np.maximum(2 * (top[which] - found), 0.0)) - root

    inside, outside = np.zeros(len(rows)), np.full(len(rows), np.inf)
    at_inside, at_outside = np.full(len(rows), -root), np.zeros(len(rows))
    searching = np.flatnonzero(np.isfinite(centre))
    offset = _NEAREST
    while len(searching) and offset <= _FARTHEST * 1.001:
        found = excess(np.full(len(searching), offset), searching)
        beyond = found > 0
        outside[searching[beyond]], at_outside[searching[beyond]] = offset, found[beyond]
        inside[searching[~beyond]], at_inside[searching[~beyond]] = offset, found[~beyond]
        searching, offset = searching[~beyond], offset * 2
    bounded = np.flatnonzero(np.isfinite(outside))
    if len(bounded):
        outside[bounded] = _root(
            lambda offset: excess(offset, bounded),
            (inside[bounded], at_inside[bounded]),
            (outside[bounded], at_outside[bounded]),
        )
    ends = np.where(np.isfinite(centre), centre + sign * outside, sign * np.inf)
    return ends[: len(estimate)], ends[len(estimate) :]


def _root(
    function: Callable[[Array], Array], below: tuple[Array, Array], above: tuple[Array, Array]
) -> Array:
    """Roots between `below` and `above`, pairs of a place and the value there, for all rows."""
    (low, at_low), (high, at_high) = below, above
    place = high
    for _ in range(_STEPS):
        place = high - at_high * (high - low) / (at_high - at_low)
        found = function(place)
        under = found < 0
        at_high_kept, at_low_kept = (
            np.where(under, at_high / 2, found),
            np.where(under, found, at_low / 2),
        )
        low, high = np.where(under, place, low), np.where(under, high, place)
        at_low, at_high = at_low_kept, at_high_kept
    return place


def _eta(what: Setting, at: float, lapse: Array) -> Array:
    share = (at - what.guess) / (1 - what.guess - lapse)
    return what.function.inverse(np.clip(share, 1e-12, 1 - 1e-12))
