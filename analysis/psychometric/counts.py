"""What was answered: right answers and trials at each level."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from analysis.errors import InputError
from analysis.psychometric.functions import Array

_ROUNDING = 1e-12  # of the largest level: levels closer than this are one


@dataclass(frozen=True, eq=False)
class Counts:
    """Right answers `correct` (L,) of `total` (L,) trials at the distinct, ascending `levels`."""

    levels: Array
    correct: Array
    total: Array

    @property
    def trials(self) -> int:
        return int(self.total.sum())


def counts(levels: ArrayLike, correct: ArrayLike, total: ArrayLike | None = None) -> Counts:
    """Counts by distinct level; without `total` each entry of `correct` (0 or 1) is one trial.

    Single trials and their counts have the same likelihood up to the binomial coefficients,
    so gathering them by level loses nothing.
    """
    x = np.atleast_1d(np.asarray(levels, float))
    k = np.atleast_1d(np.asarray(correct, float))
    n = np.ones_like(k) if total is None else np.atleast_1d(np.asarray(total, float))
    _check(x, k, n)
    distinct, place = merged(x)
    size = len(distinct)
    n_at = np.bincount(place, n, size)
    k_at = np.bincount(place, k, size)
    kept = n_at > 0
    return Counts(distinct[kept], k_at[kept], n_at[kept])


def merged(levels: Array) -> tuple[Array, Array]:
    """The distinct levels (L,), ascending, and the place of each of `levels` (N,) among them.

    Levels that differ by rounding alone are one: 0.1 + 0.2 of a staircase is the 0.3 of a table.
    """
    ordered, place = np.unique(levels, return_inverse=True)
    if len(ordered) == 0:
        return ordered, place
    grain = _ROUNDING * np.abs(ordered).max()
    first = np.append(True, np.diff(ordered) > grain)
    return ordered[first], (np.cumsum(first) - 1)[place]


def _check(x: Array, k: Array, n: Array) -> None:
    if not (x.ndim == k.ndim == n.ndim == 1 and len(x) == len(k) == len(n)):
        raise InputError(
            "levels, correct and total: expected three columns of equal length, "
            f"found {x.shape}, {k.shape} and {n.shape}"
        )
    if not (np.isfinite(x).all() and np.isfinite(k).all() and np.isfinite(n).all()):
        raise InputError("levels, correct and total: expected finite numbers throughout")
    wrong = np.flatnonzero((k < 0) | (n < 0) | (k > n) | (k % 1 != 0) | (n % 1 != 0))
    if len(wrong):
        at = wrong[0]
        raise InputError(
            f"row {at + 1}: expected whole counts with correct of at most total, "
            f"found {k[at]:g} of {n[at]:g}"
        )
    if n.sum() == 0:
        raise InputError("levels, correct and total: expected at least one trial, found none")
