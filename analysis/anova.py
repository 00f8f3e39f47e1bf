"""Two-way analyses of variance of ratings: method by order of presentation.

`independent` takes every rating as independent, as the dissertation did (its F(1, 48));
`split_plot` knows that each person rated both methods and was in one order only.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.stats import f as f_distribution
from scipy.stats import ncf

from analysis.psychometric.functions import Array


@dataclass(frozen=True)
class Effect:
    """One F test, with partial η² and the interval of its noncentral F; nan where 0 is held
    against 0, of ratings that do not differ at all."""

    name: str
    statistic: float
    df: tuple[int, int]
    p: float
    effect_size: float
    low: float
    high: float
    mean_square: float


def independent(ratings: Array, method: Array, order: Array) -> list[Effect]:
    """Effects of method, order and their interaction on ratings (N,), all taken as independent.

    `method` and `order` (N,) are −1 or 1. Type III sums of squares.
    """
    design = np.stack([np.ones_like(ratings), method, order, method * order], 1)
    df = len(ratings) - 4
    error = _residual(design, ratings)
    names = ("method", "order", "method × order")
    return [
        _effect(name, _residual(np.delete(design, place, 1), ratings) - error, error / df, df)
        for place, name in enumerate(names, start=1)
    ]


def split_plot(a: Array, b: Array, order: Array) -> list[Effect]:
    """The same effects with method within people: ratings of both methods (P,), order (P,) ±1."""
    difference, mean = b - a, (a + b) / 2
    df = len(a) - 2
    between, within = order < 0, order > 0
    share = 1 / between.sum() + 1 / within.sum()
    effects = []
    for name, score, contrast, scale in (
        ("method", difference, 0.5, 2.0),
        ("order", mean, -1.0, 0.5),
        ("method × order", difference, -1.0, 2.0),
    ):
        first, second = score[between], score[within]
        spread = (((first - first.mean()) ** 2).sum() + ((second - second.mean()) ** 2).sum()) / df
        weight = 0.25 if contrast > 0 else 1.0
        estimate = (
            (first.mean() + second.mean()) / 2 if contrast > 0 else first.mean() - second.mean()
        )
        # The mean square is in units of single ratings, as a split-plot table prints it.
        square = estimate**2 / (share * weight) / scale
        effects.append(_effect(name, square, spread / scale, df))
    return effects


def _residual(design: Array, values: Array) -> float:
    fitted = design @ np.linalg.lstsq(design, values, rcond=None)[0]
    return float(((values - fitted) ** 2).sum())


def _effect(name: str, square: float, error: float, df: int) -> Effect:
    if error <= 0 and square <= 0:
        none = float("nan")
        return Effect(name, none, (1, df), none, none, none, none, float(square))
    statistic = square / error if error > 0 else float("inf")
    p = float(f_distribution.sf(statistic, 1, df))
    size = statistic / (statistic + df) if np.isfinite(statistic) else 1.0
    low, high = eta_interval(statistic, 1, df)
    return Effect(name, float(statistic), (1, df), p, float(size), low, high, float(square))


def eta_interval(statistic: float, df1: int, df2: int, level: float = 0.95) -> tuple[float, float]:
    """Interval of partial η² by inverting the noncentral F (Steiger 2004)."""
    if not np.isfinite(statistic) or df2 < 1:
        return 0.0, 1.0

    def end(tail: float) -> float:
        def excess(noncentrality: float) -> float:
            return float(ncf.cdf(statistic, df1, df2, noncentrality)) - tail

        if excess(1e-9) < 0:
            return 0.0
        top = 4 * statistic + 40
        return float(brentq(excess, 1e-9, top)) if excess(top) < 0 else top

    total = df1 + df2 + 1
    low, high = end((1 + level) / 2), end((1 - level) / 2)
    return low / (low + total), high / (high + total)
