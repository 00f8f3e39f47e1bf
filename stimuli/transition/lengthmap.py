"""The optimal length of every (i, j) at once (Wang 2005, V.1): means along diagonals.

A blend's cost is the mean of the pose-distance matrix along a piece of one diagonal, so prefix
sums along the diagonals give it with one subtraction for each length.
"""

from collections.abc import Callable, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np

from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.ties import ROUNDING
from stimuli.transition.distance import pose_distance
from stimuli.transition.weights import Weights
from stimuli.transition.window import LONGEST, specified

_MANY = 1_000_000  # cells; below, loading the compiler costs more than it saves
_SUMS = 1e-14  # of the largest sum, by which sums round beyond what costs do
_STRIP = 256  # cells whose best stays in a core's nearest memory over all lengths
# For each piece: its length b, where it starts and how many cells it has, from (i, j)
Pieces = tuple[tuple[int, int, int, int], ...]


def length_map(
    a: Motion, b: Motion, specification: str = "start-end", weights: str | Weights = "wang"
) -> tuple[np.ndarray, Array]:
    """Optimal geodesic length (FA, FB) for every pair of frames, 0 where none fits, and its cost.

    The cost is infinite where no length fits; the smaller length on a tie.
    """
    specified(specification)
    return lengths_of(pose_distance(a, b, weights), specification)


def lengths_of(distance: np.ndarray, specification: str) -> tuple[np.ndarray, Array]:
    """The same from a pose-distance matrix."""
    sums = diagonal_sums(distance)
    frames = np.zeros(distance.shape, dtype=np.int64)
    least = np.full(distance.shape, np.inf)
    pieces = _PIECES[specification]
    tie = max(ROUNDING, _SUMS * float(sums.max()))
    if distance.size > _MANY:
        _compiled()(sums, np.array(pieces), tie, frames, least)
        return frames, least
    for length, up, left, count in pieces:
        rows = slice(up, distance.shape[0] - (count - 1 - up))
        columns = slice(left, distance.shape[1] - (count - 1 - left))
        if rows.start >= rows.stop or columns.start >= columns.stop:
            continue
        total = sums[count:, count:] - sums[:-count, :-count]
        mean = total * (1.0 / count)
        better = mean + tie < least[rows, columns]
        least[rows, columns] = np.where(better, mean, least[rows, columns])
        frames[rows, columns] = np.where(better, length, frames[rows, columns])
    return frames, least


def diagonal_sums(distance: np.ndarray) -> Array:
    """S (FA+1, FB+1) with S[r+1, c+1] = S[r, c] + D[r, c], in double precision."""
    sums = np.zeros((distance.shape[0] + 1, distance.shape[1] + 1))
    for row in range(distance.shape[0]):
        np.add(sums[row, :-1], distance[row], out=sums[row + 1, 1:])
    return sums


def _start_end() -> Pieces:
    """A[i … i+b−1] with B[j−b+1 … j]: the piece starts at (i, j−b+1)."""
    return tuple((b, 0, b - 1, b) for b in range(1, LONGEST + 1))


def _center_aligned() -> Pieces:
    """2h + 1 cells around (i, j), h = b // 2; of the two b with one h the smaller."""
    lengths = [1, *range(2, LONGEST + 1, 2)]
    return tuple((b, b // 2, b // 2, 2 * (b // 2) + 1) for b in lengths)


_PIECES: Mapping[str, Pieces] = MappingProxyType(
    {"start-end": _start_end(), "center-aligned": _center_aligned()}
)


@cache
def _compiled() -> Callable[..., Any]:
    """The same loop on all cores, strip by strip of a row, compiled on the first call."""
    import numba

    from stimuli.compiled import compiled

    @compiled(parallel=True)
    def fill(sums: Array, pieces: np.ndarray, tie: float, frames: np.ndarray, least: Array) -> None:
        height, width = frames.shape
        for i in numba.prange(height):
            for first in range(0, width, _STRIP):
                beyond = min(first + _STRIP, width)
                best, chosen = np.full(_STRIP, np.inf), np.zeros(_STRIP, np.int64)
                for p in range(pieces.shape[0]):
                    length, up, left, count = pieces[p]
                    top = i - up
                    start = max(first, left)
                    n = min(beyond, width - (count - 1 - left)) - start
                    if top < 0 or top + count > height or n <= 0:
                        continue
                    begins = sums[top, start - left : start - left + n]
                    ends = sums[top + count, start - left + count : start - left + count + n]
                    cost = best[start - first : start - first + n]
                    of = chosen[start - first : start - first + n]
                    share = 1.0 / count
                    for k in range(n):
                        mean = (ends[k] - begins[k]) * share
                        if mean + tie < cost[k]:
                            cost[k] = mean
                            of[k] = length
                least[i, first:beyond] = best[: beyond - first]
                frames[i, first:beyond] = chosen[: beyond - first]

    return fill
