"""The psychometric functions, forward and inverse.

With x a level, the proportion of right answers is `guess + (1 − guess − lapse)·F(x)`. Every F
here is a fixed curve of a straight line in a transformed level, `F = cdf(η)` with
`η = slope·scale·(t(x) − t(location))`, so one fitting routine serves all of them:

    logistic           1 / (1 + exp(−slope·(x − location)))
    cumulative-normal  Φ(slope·(x − location))
    weibull            1 − exp(−(x / location)^slope)
    gumbel             1 − exp(−10^(slope·(x − location)))
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import expit, logit, ndtr, ndtri

from analysis.errors import InputError

Array = np.ndarray[Any, np.dtype[Any]]
Curve = Callable[[Array], Array]

_ROOT_TAU = float(np.sqrt(2 * np.pi))


@dataclass(frozen=True)
class Function:
    """One psychometric function: its curve of η and how a level becomes η."""

    name: str
    cdf: Curve
    survival: Curve  # 1 − cdf, precise where cdf is near 1
    parts: Callable[[Array], tuple[Array, Array, Array]]  # cdf, survival, derivative of cdf
    inverse: Curve
    transform: Curve  # level to the scale on which η is straight
    untransform: Curve
    scale: float  # η per unit of slope and of transformed level


def _same(values: Array) -> Array:
    return values


def _log(levels: Array) -> Array:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.log(levels)


def _exp(values: Array) -> Array:
    with np.errstate(over="ignore"):
        return np.exp(values)


def _cloglog(eta: Array) -> Array:
    return -np.expm1(-_exp(eta))


def _cloglog_survival(eta: Array) -> Array:
    return np.exp(-_exp(eta))


def _cloglog_parts(eta: Array) -> tuple[Array, Array, Array]:
    hazard = _exp(np.minimum(eta, 700.0))
    return -np.expm1(-hazard), np.exp(-hazard), hazard * np.exp(-hazard)


def _cloglog_inverse(proportion: Array) -> Array:
    with np.errstate(divide="ignore"):
        return np.log(-np.log1p(-proportion))


def _logistic_parts(eta: Array) -> tuple[Array, Array, Array]:
    above, below = expit(eta), expit(-eta)
    return above, below, above * below


def _normal_parts(eta: Array) -> tuple[Array, Array, Array]:
    return ndtr(eta), ndtr(-eta), np.exp(-0.5 * eta * eta) / _ROOT_TAU


def _reflected(curve: Curve) -> Curve:
    return lambda eta: curve(-eta)


_CLOGLOG = (_cloglog, _cloglog_survival, _cloglog_parts, _cloglog_inverse)

FUNCTIONS: dict[str, Function] = {
    function.name: function
    for function in (
        Function("logistic", expit, _reflected(expit), _logistic_parts, logit, _same, _same, 1.0),
        Function(
            "cumulative-normal",
            ndtr,
            _reflected(ndtr),
            _normal_parts,
            ndtri,
            _same,
            _same,
            1.0,
        ),
        Function("weibull", *_CLOGLOG, _log, _exp, 1.0),
        Function("gumbel", *_CLOGLOG, _same, _same, float(np.log(10.0))),
    )
}


def function_named(function: str | Function) -> Function:
    """The function of that name; raises InputError naming the ones there are."""
    if isinstance(function, Function):
        return function
    try:
        return FUNCTIONS[function]
    except KeyError:
        raise InputError(
            f"psychometric function: expected one of {', '.join(FUNCTIONS)}, found {function!r}"
        ) from None


def check_rates(guess: float, lapse: float) -> None:
    """Raise InputError unless guess and lapse leave the function something to rise through."""
    if not (0 <= guess < 1 and 0 <= lapse < 1 and guess + lapse < 1):
        raise InputError(
            "guess and lapse: expected rates of at least 0 that add up to less than 1, "
            f"found guess {guess:g} and lapse {lapse:g}"
        )


def proportion(
    function: str | Function,
    level: ArrayLike,
    location: ArrayLike,
    slope: ArrayLike,
    guess: ArrayLike = 0.5,
    lapse: ArrayLike = 0.0,
) -> Array:
    """Proportion of right answers at `level`; all arguments broadcast."""
    shape = function_named(function)
    guess, lapse = np.asarray(guess, float), np.asarray(lapse, float)
    return guess + (1 - guess - lapse) * shape.cdf(_eta(shape, level, location, slope))


def level_at(
    function: str | Function,
    at: ArrayLike,
    location: ArrayLike,
    slope: ArrayLike,
    guess: ArrayLike = 0.5,
    lapse: ArrayLike = 0.0,
) -> Array:
    """Level at which the proportion is `at`; nan unless `guess < at < 1 − lapse`."""
    shape = function_named(function)
    step = _eta_at(shape, at, guess, lapse) / (np.asarray(slope, float) * shape.scale)
    return np.asarray(shape.untransform(shape.transform(np.asarray(location, float)) + step))


def location_for(
    function: str | Function,
    level: ArrayLike,
    at: ArrayLike,
    slope: ArrayLike,
    guess: ArrayLike = 0.5,
    lapse: ArrayLike = 0.0,
) -> Array:
    """Location that puts the proportion `at` at `level`: the inverse of `level_at`."""
    shape = function_named(function)
    step = _eta_at(shape, at, guess, lapse) / (np.asarray(slope, float) * shape.scale)
    return np.asarray(shape.untransform(shape.transform(np.asarray(level, float)) - step))


def _eta(shape: Function, level: ArrayLike, location: ArrayLike, slope: ArrayLike) -> Array:
    distance = shape.transform(np.asarray(level, float)) - shape.transform(
        np.asarray(location, float)
    )
    return np.asarray(slope, float) * shape.scale * distance


def _eta_at(shape: Function, at: ArrayLike, guess: ArrayLike, lapse: ArrayLike) -> Array:
    guess, lapse = np.asarray(guess, float), np.asarray(lapse, float)
    share = (np.asarray(at, float) - guess) / (1 - guess - lapse)
    return shape.inverse(np.where((share > 0) & (share < 1), share, np.nan))
