"""A second opinion on a fit: psignifit, Bayesian, where it is installed.

psignifit writes its functions otherwise. Its `weibull` is a Gumbel curve of the levels as they
are, and a Weibull curve of the levels themselves where it is given their logarithms; so ours is.
Its own intervals are for the level at a share of the curve, which leaves the lapse rate out: ours
is for a proportion, so that value and interval both come from the posterior of that proportion's
level.
"""

import warnings
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

import numpy as np

from analysis.psychometric.counts import Counts
from analysis.psychometric.fit import Setting
from analysis.psychometric.functions import Array

# Ours → theirs; on transformed levels both of the complementary log-log family are one curve.
SIGMOIDS = {
    "logistic": "logistic",
    "cumulative-normal": "norm",
    "weibull": "weibull",
    "gumbel": "weibull",
}
_LEVEL = 0.95


@dataclass(frozen=True)
class Opinion:
    """Another tool's threshold at the same proportion."""

    value: float
    low: float
    high: float
    method: str


def second_opinion(data: Counts, what: Setting, at: float) -> Opinion | None:
    """psignifit's threshold with its 95 % credible interval; None where it is absent or fails."""
    try:
        import psignifit
    except ImportError:
        return None
    levels = what.function.transform(data.levels)
    if len(levels) < 2 or not np.isfinite(levels).all():
        return None
    table = np.stack([levels, data.correct, data.total], 1)
    fixed = {"gamma": what.guess} | ({} if what.lapse is None else {"lambda": what.lapse})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            found = psignifit.psignifit(
                table,
                experiment_type="nAFC" if 0 < what.guess < 1 else "yes/no",
                experiment_choices=max(round(1 / what.guess), 2) if what.guess else None,
                sigmoid=SIGMOIDS[what.function.name],
                fixed_parameters=fixed,
                debug=True,
            )
            value, low, high = _at_proportion(found, what, at)
        except Exception:
            # Whatever stops another tool on some table must not stop the report.
            return None
    restore = what.function.untransform
    value, low, high = (float(restore(np.array(end))) for end in (value, low, high))
    return Opinion(value, low, high, f"psignifit {version('psignifit')}, Bayesian")


def _at_proportion(found: Any, what: Setting, at: float) -> tuple[float, float, float]:
    """Median and central interval of the level at proportion `at` over psignifit's posterior."""
    names = list(found.parameter_values)  # in the order of the posterior's axes
    axes = [np.atleast_1d(found.parameter_values[name]) for name in names]
    mass = np.asarray(found.debug["posteriors"], float)
    grid = dict(zip(names, np.meshgrid(*axes, indexing="ij"), strict=True))
    share = (at - what.guess) / (1 - what.guess - grid["lambda"])
    reached = (share > 0) & (share < 1)
    sigmoid = found.configuration.make_sigmoid()
    level = np.full(share.shape, np.inf)
    level[reached] = sigmoid.inverse(
        share[reached], grid["threshold"][reached], grid["width"][reached]
    )
    return _quantiles(level.ravel(), mass.ravel())


def _quantiles(values: Array, mass: Array) -> tuple[float, float, float]:
    order = np.argsort(values)
    along = np.cumsum(mass[order]) / mass.sum()
    places = np.searchsorted(along, [0.5, (1 - _LEVEL) / 2, (1 + _LEVEL) / 2])
    middle, low, high = values[order][np.minimum(places, len(values) - 1)]
    return float(middle), float(low), float(high)
