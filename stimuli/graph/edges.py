"""Where clips may be cut to one another: every two frames whose cost is under a threshold.

Blocks of the matrix of costs come out of a product in single precision; what lies near the
threshold or under it is reckoned anew in double precision, which decides: the edges do not depend
on how a machine multiplies.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from stimuli.collection import Collection
from stimuli.graph.arrays import Indices
from stimuli.graph.cost import metric_of
from stimuli.motion.quaternions import Array

_APART = 15  # frames: nearer ones of one clip are the same moment of it
ROWS = 1024  # of the matrix at once, whatever the length of a clip
SLACK = 1e-5  # of the largest squared norm, by which single precision may be wrong


class Edges(NamedTuple):
    """Edges that leave one clip, by clip entered, then frame left, then frame entered."""

    to_clip: Indices
    from_frame: Indices
    to_frame: Indices
    cost: Array


@dataclass(frozen=True, eq=False)
class CutSpace:
    """The rows of all clips, whose squared distances are costs, and where each clip begins."""

    rows: Array  # (F, D), centred
    starts: np.ndarray  # (N + 1,)
    tau: float

    def edges_from(self, clip: int) -> Edges:
        """The edges that leave a clip for any other, or for itself."""
        from stimuli.graph.edges_loop import costs_of

        first, stop = int(self.starts[clip]), int(self.starts[clip + 1])
        found = [self.near(row, min(row + ROWS, stop)) for row in range(first, stop, ROWS)]
        i, j = (np.concatenate(part) for part in zip(*found, strict=True))
        to_clip = np.searchsorted(self.starts, j, side="right").astype(np.int32) - np.int32(1)
        keep = (to_clip != clip) | (np.abs(i - j) > _APART)
        i, j, to_clip = i[keep], j[keep], to_clip[keep]
        cost = costs_of(self.rows, i, j)
        keep = cost < self.tau
        i, j, to_clip, cost = i[keep], j[keep], to_clip[keep], cost[keep]
        order = np.argsort(to_clip, kind="stable")
        i, j, to_clip = i[order], j[order], to_clip[order]
        local = (j - self.starts[to_clip]).astype(np.int32)
        return Edges(to_clip, (i - first).astype(np.int32), local, cost[order])

    def near(self, first: int, stop: int) -> tuple[np.ndarray, np.ndarray]:
        """Pairs of frames (global) of which the first lies in these rows, that may be edges."""
        from stimuli.graph.edges_loop import below

        left, right, limit = self.factors
        block = left[first:stop] @ right
        i, j = below(block, np.float32(limit))
        return i + first, j

    def least(self) -> float:
        """The cost of the nearest two frames that may be joined, infinite where none may."""
        left, right, _ = self.factors
        clip = np.repeat(np.arange(len(self.starts) - 1), np.diff(self.starts))
        at, least = np.arange(len(clip)), np.inf
        for first in range(0, len(clip), ROWS):
            part = slice(first, first + ROWS)
            block = left[part] @ right
            same = clip[part, None] == clip
            block[same & (np.abs(at[part, None] - at) <= _APART)] = np.inf
            i, j = np.unravel_index(int(block.argmin()), block.shape)
            if np.isfinite(block[i, j]):
                least = min(least, float(np.square(self.rows[first + i] - self.rows[j]).sum()))
        return least

    @cached_property
    def factors(self) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32], float]:
        """Two matrices whose product is the matrix of costs, and what no edge's cost exceeds."""
        squares = np.square(self.rows).sum(axis=1)[:, None]
        ones = np.ones_like(squares)
        left = np.concatenate([-2.0 * self.rows, squares, ones], axis=1)
        right = np.concatenate([self.rows, ones, squares], axis=1)
        return (
            np.ascontiguousarray(left, dtype=np.float32),
            np.ascontiguousarray(right.T, dtype=np.float32),
            self.tau + SLACK * (1.0 + float(squares.max())),
        )


def cut_space(collection: Collection, tau: float) -> CutSpace:
    """The space in which a collection's frames are compared."""
    metric = metric_of(collection)
    rows = np.concatenate([metric.rows(motion) for motion in collection.motions])
    return CutSpace(rows - rows.mean(axis=0), collection.starts, tau)
