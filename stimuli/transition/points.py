"""Where to join two motions: the cost's local minima (Wang 2005, IV.1) and its probabilities."""

from dataclasses import dataclass

import numpy as np

from stimuli.motion.quaternions import Array
from stimuli.ties import ROUNDING, first_least, ranks

TRIVIAL = 15  # frames: half a second around the diagonal a motion goes on into itself


@dataclass(frozen=True)
class TransitionPoint:
    """A transition from frame i to frame j and its cost."""

    i: int
    j: int
    cost: float


def local_minima(
    cost: Array, before: int = 0, after: int = 0, trivial: int = -1
) -> list[TransitionPoint]:
    """Cells of `cost` (FA, FB) below or level with their 8 neighbours, cheapest first.

    Cells with fewer than `before` frames before i or `after` frames behind j are left out;
    `trivial` excludes cells with |i − j| ≤ it: a motion that goes on into itself. A plateau counts
    once, by its first cell that is not left out, and only where nothing around it is lower.
    """
    lower = np.full(cost.shape, False)
    for di, dj in _NEIGHBOURS:
        here, there = _overlap(cost.shape, di, dj)
        lower[here] |= cost[there] < cost[here] - ROUNDING
    allowed = _allowed(cost.shape, before, after, trivial)
    cells = np.argwhere(_plateaus(cost, lower, allowed))
    found = [TransitionPoint(int(i), int(j), float(cost[i, j])) for i, j in cells]
    levels = ranks([point.cost for point in found])
    places = sorted(range(len(found)), key=lambda n: (levels[n], found[n].i, found[n].j))
    return [found[n] for n in places]


def cheapest(
    cost: Array, before: int = 0, after: int = 0, trivial: int = -1
) -> TransitionPoint | None:
    """The cheapest cell that qualifies, the first of equals; None when none does."""
    allowed = np.where(_allowed(cost.shape, before, after, trivial), cost, np.inf)
    i, j = np.unravel_index(first_least(allowed), cost.shape)
    if not np.isfinite(allowed[i, j]):
        return None
    return TransitionPoint(int(i), int(j), float(cost[i, j]))


def default_sigma(cost: Array, trivial: int = -1) -> float:
    """σ of IV.1 where none is given: the mean over the frames of their cheapest cost.

    `trivial` excludes what `local_minima` excludes; without it a motion against itself has σ = 0.
    """
    least = np.where(_allowed(cost.shape, 0, 0, trivial), cost, np.inf).min(axis=1)
    possible = least[np.isfinite(least)]
    return float(possible.mean()) if possible.sum() > 0 else 1.0


def probabilities(cost: Array, sigma: float) -> Array:
    """P(i, j) ∝ exp(−D(i, j−1)/σ) (IV.1), each row summing to 1; frame 0 is entered from nowhere.

    σ is above 0, in the unit of the cost.
    """
    shifted = cost[:, :-1]
    likely = np.zeros(cost.shape)
    if shifted.shape[1]:
        with np.errstate(over="ignore"):  # a tiny σ leaves the cheapest alone
            excess = (shifted - shifted.min(axis=1, keepdims=True)) / sigma
        likely[:, 1:] = np.exp(-excess)
        likely /= likely.sum(axis=1, keepdims=True)
    return likely


def _allowed(shape: tuple[int, ...], before: int, after: int, trivial: int) -> np.ndarray:
    """Cells with `before` frames before i, `after` behind j, farther than `trivial` from i = j."""
    i, j = np.ogrid[: shape[0], : shape[1]]
    return np.asarray((i >= before) & (j < shape[1] - after) & (np.abs(i - j) > trivial))


_NEIGHBOURS = [(di, dj) for di in (-1, 0, 1) for dj in (-1, 0, 1) if (di, dj) != (0, 0)]


def _overlap(
    shape: tuple[int, ...], di: int, dj: int
) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
    """Slices of the cells that have a neighbour at (di, dj), and of those neighbours."""

    def pair(size: int, step: int) -> tuple[slice, slice]:
        return slice(max(-step, 0), size - max(step, 0)), slice(max(step, 0), size + min(step, 0))

    (i_here, i_there), (j_here, j_there) = pair(shape[0], di), pair(shape[1], dj)
    return (i_here, j_here), (i_there, j_there)


def _plateaus(cost: Array, lower: np.ndarray, allowed: np.ndarray) -> np.ndarray:
    """The first allowed cell of every connected level region without a lower neighbour anywhere.

    Of two neighbours at two levels one is in `lower`: what is connected among the others is level.
    """
    from scipy.ndimage import label

    spoiled = np.full(cost.shape, False)  # in a region that goes on to where a neighbour is lower
    for di, dj in _NEIGHBOURS:
        here, there = _overlap(cost.shape, di, dj)
        spoiled[here] |= (np.abs(cost[there] - cost[here]) <= ROUNDING) & lower[there]
    regions, count = label(~lower, np.ones((3, 3), dtype=int))
    sound = np.full(count + 1, True)
    sound[regions[spoiled]] = False
    sound[0] = False
    places = np.flatnonzero(sound[regions] & allowed)
    firsts = np.unique(regions.ravel()[places], return_index=True)[1]
    keep = np.full(cost.shape, False)
    keep.ravel()[places[firsts]] = True
    return keep
