"""Rank tests with their exact distributions, ties included.

Signed-rank: zero differences are left out (Wilcoxon 1945), tied ones share their mean rank.
Rank-sum: tied values share their mean rank. Values that differ by rounding alone are tied: means of
ratings that are equal in arithmetic differ in their last bit. Up to EXACT_UP_TO observations the
p value is exact, from the permutation distribution of the very ranks observed (so ties cost
nothing); beyond it the normal approximation with the tie correction and without continuity
correction is used.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtr
from scipy.stats import rankdata

from analysis.psychometric.functions import Array

EXACT_UP_TO = 60
_ROUNDING = 1e-9  # of the largest value: what differs by less differs by rounding alone


@dataclass(frozen=True)
class RankTest:
    """A rank test: V or U, its two-sided p, the rank-biserial correlation, and how it was got.

    The numbers are None where there is nothing to rank: no difference but 0, or an empty group.
    """

    statistic: float | None
    p: float | None
    effect_size: float | None
    n: int
    zeros: int
    ties: bool
    exact: bool

    @property
    def how(self) -> str:
        """The treatment in words."""
        if self.p is None:
            return (
                f"no test: no difference but 0 in {self.zeros}"
                if self.zeros
                else "no test: a group without ratings"
            )
        parts = ["exact" if self.exact else "normal approximation, ties corrected"]
        if self.ties:
            parts.append("mean ranks for ties")
        if self.zeros:
            parts.append(
                f"{self.zeros} zero {'difference' if self.zeros == 1 else 'differences'} left out"
            )
        return ", ".join(parts)


def signed_rank(differences: ArrayLike) -> RankTest:
    """Wilcoxon's signed-rank test of differences about 0; V is the sum of the positive ranks."""
    d = snapped(np.asarray(differences, float))
    kept = d[d != 0]
    n = len(kept)
    if n == 0:
        return RankTest(None, None, None, 0, len(d), False, True)
    ranks = rankdata(np.abs(kept))
    v = float(ranks[kept > 0].sum())
    whole = float(ranks.sum())
    exact = n <= EXACT_UP_TO
    if exact:
        p = _two_sided(_subset_sums(ranks, None), round(2 * v))
    else:
        p = _normal(v - whole / 2, float((ranks**2).sum()) / 4)
    ties = len(np.unique(np.abs(kept))) < n
    return RankTest(v, p, 2 * v / whole - 1, n, len(d) - n, ties, exact)


def rank_sum(first: ArrayLike, second: ArrayLike) -> RankTest:
    """Wilcoxon's rank-sum test; U counts the pairs in which the first group is higher."""
    x, y = np.asarray(first, float), np.asarray(second, float)
    n, m = len(x), len(y)
    x, y = np.split(snapped(np.concatenate([x, y])), [n])
    if n == 0 or m == 0:
        return RankTest(None, None, None, n + m, 0, False, True)
    ranks = rankdata(np.concatenate([x, y]))
    w = float(ranks[:n].sum())
    u = w - n * (n + 1) / 2
    exact = n + m <= EXACT_UP_TO
    if exact:
        p = _two_sided(_subset_sums(ranks, n), round(2 * w))
    else:
        variance = n * m * float(((ranks - (n + m + 1) / 2) ** 2).sum()) / ((n + m) * (n + m - 1))
        p = _normal(u - n * m / 2, variance)
    ties = len(np.unique(ranks)) < n + m
    return RankTest(u, p, 2 * u / (n * m) - 1, n + m, 0, ties, exact)


def snapped(values: Array) -> Array:
    """Values of any shape, those that differ by rounding alone made equal, 0 among them."""
    largest = np.abs(values).max(initial=0.0)
    if largest == 0:
        return values
    grain = largest * _ROUNDING
    sizes = np.abs(values)
    ordered = np.unique(np.append(0.0, sizes))
    first = np.append(True, np.diff(ordered) > grain)
    shared = ordered[first][np.cumsum(first) - 1]
    return np.sign(values) * shared[np.searchsorted(ordered, sizes)]


def _subset_sums(ranks: Array, size: int | None) -> Array:
    """How many subsets (of `size` members, or any) have each doubled sum: ways (S + 1,)."""
    doubled = np.rint(2 * ranks).astype(int)
    top = int(doubled.sum())
    if size is None:
        ways = np.zeros(top + 1)
        ways[0] = 1
        for rank in doubled:
            ways[rank:] = ways[rank:] + ways[: top + 1 - rank]
        return ways
    table = np.zeros((size + 1, top + 1))
    table[0, 0] = 1
    for rank in doubled:
        table[1:, rank:] = table[1:, rank:] + table[:-1, : top + 1 - rank]
    return table[size]


def _two_sided(ways: Array, doubled: int) -> float:
    """Probability of a sum at least as far out, doubled, at most one."""
    total = ways.sum()
    lower, upper = ways[: doubled + 1].sum() / total, ways[doubled:].sum() / total
    return float(min(1.0, 2 * min(lower, upper)))


def _normal(deviation: float, variance: float) -> float:
    if variance <= 0:
        return 1.0
    return float(2 * ndtr(-abs(deviation) / np.sqrt(variance)))


def biserial_signed(differences: Array) -> Array:
    """Matched-pairs rank-biserial correlation of each row of differences (B, N)."""
    differences = snapped(differences)
    ranks = rankdata(np.where(differences == 0, 0.0, np.abs(differences)), axis=1)
    ranks = ranks - (differences == 0).sum(1, keepdims=True)  # zeros hold the lowest ranks
    whole = np.where(differences == 0, 0.0, ranks).sum(1)
    positive = np.where(differences > 0, ranks, 0.0).sum(1)
    return np.where(whole > 0, 2 * positive / np.maximum(whole, 1e-12) - 1, 0.0)


def biserial_sum(first: Array, second: Array) -> Array:
    """Rank-biserial correlation of rows (B, N) against rows (B, M): P(x > y) − P(x < y)."""
    both = snapped(np.concatenate([first, second], 1))
    first, second = np.split(both, [first.shape[1]], axis=1)
    return np.sign(first[:, :, None] - second[:, None, :]).mean((1, 2))
