"""Maximum-likelihood fits of a psychometric function, one or thousands at a time.

Inside, the function is written `p = guess + (1 − guess − lapse)·F(a + b·z)` with z the
transformed level brought to about −1..1, so that one grid of starts suits every table. The
whole grid is evaluated for every row by two matrix products, and polished by Fisher scoring: no
fit depends on a guessed start. The likelihood may have several maxima along the slope, so that a
fit climbs from the best start of every slope; resamples, which are many, from the best of all.
"""

from dataclasses import dataclass

import numpy as np

from analysis.errors import InputError
from analysis.psychometric.counts import Counts
from analysis.psychometric.functions import Array, Function, check_rates, function_named
from analysis.psychometric.scoring import (
    ITERATIONS,
    THOROUGH,
    TINY,
    TOLERANCE,
    log_likelihood,
    maximise,
)

LAPSE_BOUND = 0.2  # a free lapse rate stays below this unless told otherwise
STEEPEST = 20.0  # bound on the change of η between neighbouring levels: beyond it, a step
FINEST = 20  # levels are told apart no finer than this share of their range
SHALLOWEST = 1e-3  # bound on the change of η over half the range of levels: below it, flat

_CENTRES = np.linspace(-2.0, 2.0, 33)
_STEEPNESSES = 14
_FINE_STEEPNESSES = 28
_FLATTEST = 0.02  # η over half the range, where the fine grid of slopes begins
_LAPSES = (0.0, 0.02, 0.06)
_FINE_LAPSES = (0.0, 0.1, 0.3, 0.5, 0.7, 0.85, 1.0)  # as shares of the bound
_STEP_SPACING = 2.0  # η between the starts at the steepest slope: a level or none is on the rise
_HOPELESS, _HOPELESS_SHARE = 4.0, 0.2  # log likelihood by which a start is not worth a climb
_MOST_CENTRES = 90
_MOST_LEVELS = 40
_TINY_SINGLE = np.float32(1e-30)
_FARTHEST_ETA = 3.0  # η that starts reach beyond the levels: farther on, nothing has a slope
_STEP_MARGIN = 10.0  # η by which they reach beyond the levels


@dataclass(frozen=True)
class Setting:
    """What is fitted: the function, the guess rate, and the lapse rate (None: free below
    `lapse_bound`)."""

    function: Function
    guess: float = 0.5
    lapse: float | None = None
    lapse_bound: float = LAPSE_BOUND


def setting(
    function: str | Function,
    guess: float = 0.5,
    lapse: float | None = None,
    lapse_bound: float = LAPSE_BOUND,
) -> Setting:
    """A checked Setting; `lapse` None leaves the rate free between 0 and `lapse_bound`."""
    check_rates(guess, lapse_bound if lapse is None else lapse)
    rate = None if lapse is None else float(lapse)
    return Setting(function_named(function), float(guess), rate, float(lapse_bound))


@dataclass(frozen=True, eq=False)
class Scale:
    """The levels as the fit sees them: z = (t(level) − centre) / half."""

    z: Array
    centre: float
    half: float
    steepest: float


def scale_of(levels: Array, function: Function) -> Scale:
    """Bring levels (L,) to about −1..1; raises InputError where the function has no such level."""
    t = function.transform(levels)
    if not np.isfinite(t).all():
        raise InputError(
            f"levels: expected numbers above 0 for the {function.name} function, "
            f"found {levels[~np.isfinite(t)][0]:g}"
        )
    low, high = float(t.min()), float(t.max())
    half = (high - low) / 2 or 1.0
    return Scale(
        (t - (low + high) / 2) / half,
        (low + high) / 2,
        half,
        STEEPEST * min(max(len(levels) - 1, 1), FINEST) / 2,
    )


@dataclass(frozen=True, eq=False)
class Batch:
    """B fits: a, b, lapse and log likelihood (B,), on the levels of `scale`."""

    setting: Setting
    scale: Scale
    a: Array
    b: Array
    lapse: Array
    value: Array

    @property
    def slope(self) -> Array:
        return self.b / (self.scale.half * self.setting.function.scale)

    @property
    def location(self) -> Array:
        return self.threshold(None)

    def threshold(self, at: float | None) -> Array:
        """Level (B,) at proportion `at` (None: at the location), infinite for a flat function."""
        function, rate = self.setting.function, self.setting.guess
        eta: Array | float = 0.0
        if at is not None:
            share = (at - rate) / (1 - rate - self.lapse)
            eta = function.inverse(np.where((share > 0) & (share < 1), share, np.nan))
        with np.errstate(divide="ignore", over="ignore"):
            z = (eta - self.a) / self.b
            return function.untransform(self.scale.centre + self.scale.half * z)


def fit_batch(
    levels: Array,
    correct: Array,
    total: Array,
    what: Setting,
    falling: bool = False,
    tolerance: float = TOLERANCE,
) -> Batch:
    """Fit every row of `correct` and `total` (B, L) at the same `levels` (L,).

    The function rises, or falls when `falling`; its slope and the free lapse rate keep to the
    bounds named above. Raises InputError for levels that the function cannot take.
    """
    scale = scale_of(levels, what.function)
    sign = -1.0 if falling else 1.0
    thorough = tolerance <= TOLERANCE
    flattest, count = (_FLATTEST, _FINE_STEEPNESSES) if thorough else (0.2, _STEEPNESSES)
    steepnesses = sign * np.geomspace(flattest, scale.steepest, count)
    if thorough:
        steepnesses = np.append(sign * SHALLOWEST, steepnesses)
    steep = (sign * scale.steepest, sign * SHALLOWEST)
    lower = np.array([-np.inf, min(steep), 0.0])
    upper = np.array([np.inf, max(steep), what.lapse_bound])
    size = 2 + (what.lapse is None)
    if thorough:
        row, start = _all_starts(scale, what, steepnesses, correct, total)
    else:
        row = np.arange(len(correct))
        start = _best_start(scale, what, _CENTRES, steepnesses, correct, total)

    def model(theta: Array, _: Array) -> tuple[Array, Array, Array]:
        return curve(scale.z, theta, what)

    theta, value = maximise(
        model,
        start[:, :size],
        lower[:size],
        upper[:size],
        correct[row],
        total[row],
        tolerance,
        ITERATIONS if not thorough else THOROUGH,
    )
    if len(row) > len(correct):
        theta, value = _best_climbs(row, theta, value)
    return _batch(what, scale, theta, value)


def _best_climbs(row: Array, theta: Array, value: Array) -> tuple[Array, Array]:
    """Of the climbs of each row, which come together, the highest."""
    order = np.lexsort((-value, row))
    best = order[np.append(True, np.diff(row[order]) > 0)]
    return theta[best], value[best]


def fit_steepest(fits: Batch, correct: Array, total: Array) -> Batch:
    """The best fits (B,) to the same data whose slope is held at the steepest that is allowed."""
    what, scale, b = fits.setting, fits.scale, fits.scale.steepest
    reach = 1 + _STEP_MARGIN / b
    centres = np.linspace(-reach, reach, round(2 * reach * b / _STEP_SPACING) + 1)
    lower, upper = np.array([-np.inf, b, 0.0]), np.array([np.inf, b, what.lapse_bound])
    start = _best_start(scale, what, centres, np.array([b]), correct, total)
    size = 2 + (what.lapse is None)

    def model(theta: Array, _: Array) -> tuple[Array, Array, Array]:
        return curve(scale.z, theta, what)

    theta, value = maximise(model, start[:, :size], lower[:size], upper[:size], correct, total)
    return _batch(what, scale, theta, value)


def _batch(what: Setting, scale: Scale, theta: Array, value: Array) -> Batch:
    lapse = np.full(len(theta), what.lapse) if what.lapse is not None else theta[:, 2]
    return Batch(what, scale, theta[:, 0], theta[:, 1], lapse, value)


def curve(z: Array, theta: Array, what: Setting) -> tuple[Array, Array, Array]:
    """Proportion (B, L), complement, and Jacobian (B, P, L) by a, b and, when free, lapse."""
    function, guess = what.function, what.guess
    eta = theta[:, :1] + theta[:, 1:2] * z
    lapse = theta[:, 2:3] if what.lapse is None else what.lapse
    span = 1 - guess - lapse
    f, rest, slant = function.parts(eta)
    slant = span * slant
    parts = [slant, slant * z]
    if what.lapse is None:
        parts.append(-f)
    return guess + span * f, lapse + span * rest, np.stack(parts, 1)


def fit(data: Counts, what: Setting, falling: bool = False) -> Batch:
    """The one fit of `data`: a batch of one row."""
    return fit_batch(data.levels, data.correct[None], data.total[None], what, falling)


def saturated(correct: Array, total: Array) -> Array:
    """Log likelihood of the proportions themselves, summed over the last axis."""
    with np.errstate(invalid="ignore", divide="ignore"):
        p = np.where(total > 0, correct / total, 0.5)
    return log_likelihood(p, 1 - p, correct, total)


def deviance(batch: Batch, correct: Array, total: Array) -> Array:
    """Twice the log likelihood (B,) that the fit loses on the observed proportions."""
    return np.maximum(2 * (saturated(correct, total) - batch.value), 0.0)


def _best_start(
    scale: Scale, what: Setting, centres: Array, slopes: Array, correct: Array, total: Array
) -> Array:
    """The start (B, 3) of highest likelihood among centres × slopes × lapses."""
    starts = _grid(what, centres, slopes, _LAPSES)
    return starts[_grid_values(scale, what, starts, correct, total).argmax(1)]


def _all_starts(
    scale: Scale, what: Setting, slopes: Array, correct: Array, total: Array
) -> tuple[Array, Array]:
    """The best start of every slope: the row of each (S,), ascending, and the starts (S, 3).

    A steep function is told from another only where a level is on the rise: the steeper, the
    closer the centres stand; a shallow one may have its centre far away. Single precision is
    enough to choose by.
    """
    centres = [_centres_of(abs(float(b))) for b in slopes]
    ends = np.cumsum([len(own) for own in centres])
    b = np.repeat(slopes, [len(own) for own in centres])
    a = -b * np.concatenate(centres)
    z, correct, total = _pooled(scale.z, correct, total)
    eta = (a[:, None] + b[:, None] * z).astype(np.float32)
    rise, rest = what.function.cdf(eta), what.function.survival(eta)
    right, wrong = correct.astype(np.float32), (total - correct).astype(np.float32)
    rates = _FINE_LAPSES if what.lapse is None else (1.0,)
    top = np.full((len(correct), len(slopes)), -np.inf)
    chosen = np.zeros((*top.shape, 2))
    firsts = np.append(0, ends[:-1])
    for share in rates:
        lapse = share * what.lapse_bound if what.lapse is None else what.lapse
        span = np.float32(1 - what.guess - lapse)
        log_p = np.log(np.maximum(np.float32(what.guess) + span * rise, _TINY_SINGLE))
        log_q = np.log(np.maximum(np.float32(lapse) + span * rest, _TINY_SINGLE))
        values = right @ log_p.T + wrong @ log_q.T
        best = np.maximum.reduceat(values, firsts, axis=1)
        better = best > top
        if better.any():
            for row, slope in zip(*np.nonzero(better), strict=True):
                own = slice(firsts[slope], ends[slope])
                place = firsts[slope] + int(values[row, own].argmax())
                chosen[row, slope] = a[place], lapse
            top = np.where(better, best, top)
    highest = top.max(1, keepdims=True)
    row, slope = np.nonzero(top >= highest - _HOPELESS - _HOPELESS_SHARE * np.abs(highest))
    place, lapse = chosen[row, slope].T
    return row, np.stack([place, slopes[slope], lapse], 1)


def _pooled(z: Array, correct: Array, total: Array) -> tuple[Array, Array, Array]:
    """Neighbouring levels taken together where there are many: enough to choose a start by."""
    if len(z) <= _MOST_LEVELS:
        return z, correct, total
    first = np.unique(np.arange(_MOST_LEVELS) * len(z) // _MOST_LEVELS)
    count = np.diff(np.append(first, len(z)))
    correct, total = (np.add.reduceat(each, first, axis=1) for each in (correct, total))
    return np.add.reduceat(z, first) / count, correct, total


def _centres_of(b: float) -> Array:
    """Centres for one slope of η by z: those of all slopes, and as many as tell it from others."""
    reach = 1 + _FARTHEST_ETA / b
    inside = np.abs(_CENTRES) <= reach
    many = round(min(2 * b, _MOST_CENTRES + b / 4)) + 33
    return np.concatenate([_CENTRES[inside], np.linspace(-reach, reach, many)])


def _grid(what: Setting, centres: Array, slopes: Array, lapses: tuple[float, ...]) -> Array:
    """Starts (S, 3) of a, b and lapse, slope by slope."""
    kept = [rate for rate in lapses if rate <= what.lapse_bound]
    rates = np.array(kept if what.lapse is None else [what.lapse])
    b, centre, lapse = (g.ravel() for g in np.meshgrid(slopes, centres, rates, indexing="ij"))
    return np.stack([-b * centre, b, lapse], 1)


def _grid_values(scale: Scale, what: Setting, starts: Array, correct: Array, total: Array) -> Array:
    """Log likelihoods (B, S) of every row at every start, in the single precision that a choice
    among starts needs."""
    eta = starts[:, :1] + starts[:, 1:2] * scale.z
    lapse = starts[:, 2:]
    span = 1 - what.guess - lapse
    log_p = np.log(np.maximum(what.guess + span * what.function.cdf(eta), TINY))
    log_q = np.log(np.maximum(lapse + span * what.function.survival(eta), TINY))
    counted = np.concatenate([correct, total - correct], 1, dtype=np.float32)
    return counted @ np.concatenate([log_p, log_q], 1, dtype=np.float32).T
