"""A second opinion on a fit: psignifit, Bayesian, where it is installed."""

import warnings
from dataclasses import dataclass
from importlib.metadata import version

import numpy as np

from analysis.psychometric.counts import Counts
from analysis.psychometric.fit import Setting

SIGMOIDS = {
    "logistic": "logistic",
    "cumulative-normal": "norm",
    "weibull": "weibull",
    "gumbel": "gumbel",
}


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
    table = np.stack([data.levels, data.correct, data.total], 1)
    fixed = {"gamma": what.guess} | ({} if what.lapse is None else {"lambda": what.lapse})
    share = (at - what.guess) / (1 - what.guess - (what.lapse or 0.0))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            found = psignifit.psignifit(
                table,
                experiment_type="2AFC",
                sigmoid=SIGMOIDS[what.function.name],
                fixed_parameters=fixed,
                thresh_PC=share,
            )
            value = float(found.threshold(at, return_ci=False))
            low, high = map(float, found.confidence_intervals["threshold"]["0.95"])
        except Exception:
            # Whatever stops another tool on some table must not stop the report.
            return None
    return Opinion(value, low, high, f"psignifit {version('psignifit')}, Bayesian")
