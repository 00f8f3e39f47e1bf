"""A motion graph as flat arrays: clips are its nodes, places to cut its edges, in a hierarchy.

Nodes of the hierarchy stand in pre-order, tree after tree: the first child of a node is the next
one, the second is at `right`, 0 where the node is a leaf, that is, an edge of G. Roots are the
edges of G′. A node's label is the mean of the leaves below it; where a path goes by it, the leaf
nearest to the label is cut at, so that a path of any level is one of G (ours: the print cuts at the
mean itself, which need not be an edge).
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from stimuli.graph.arrays import Indices
from stimuli.motion.quaternions import Array

START = -1  # the clip that edges at which a motion starts come from


class Cuts(NamedTuple):
    """Edges of G: frame `i` of `from_clip` is followed by the one after frame `j` of `to_clip`."""

    from_clip: Indices
    i: Indices
    to_clip: Indices
    j: Indices
    cost: Array

    def __len__(self) -> int:
        return len(self.cost)


@dataclass(frozen=True, eq=False)
class MotionGraph:
    """The graph of a collection at a threshold τ, and the hierarchy of its edges."""

    names: tuple[str, ...]
    frames: Indices  # (N,) of each clip
    tau: float
    collection: str  # its hash
    labels: npt.NDArray[np.float32]  # (M, 3) mean frame left, frame entered, cost
    right: Indices  # (M,)
    leaf: Indices  # (M,) the leaf nearest to each node's label
    roots: Indices  # (R,) ascending
    root_from: Indices  # (R,) the clip that a root's edges leave, ascending
    root_to: Indices  # (R,) and enter, ascending for each clip left

    @property
    def node_from(self) -> Indices:
        """The clip (M,) that each node's edges leave."""
        return self._spread(self.root_from)

    @property
    def node_to(self) -> Indices:
        """The clip (M,) that each node's edges enter."""
        return self._spread(self.root_to)

    def _spread(self, of_roots: Indices) -> Indices:
        return np.repeat(of_roots, np.diff(np.append(self.roots, len(self.right))))

    @cached_property
    def leaves(self) -> npt.NDArray[np.int64]:
        """The nodes that are edges of G, ascending."""
        return np.flatnonzero(self.right == 0)

    @cached_property
    def cuts(self) -> Cuts:
        """All edges of G, in the order of the leaves."""
        leaves = self.leaves
        i, j = (self.labels[leaves, column].astype(np.int32) for column in (0, 1))
        cost = self.labels[leaves, 2].astype(float)
        return Cuts(self.node_from[leaves], i, self.node_to[leaves], j, cost)

    @cached_property
    def joined(self) -> npt.NDArray[np.bool_]:
        """Which clips (N, N) have an edge from the one to the other."""
        matrix = np.zeros((len(self.names), len(self.names)), dtype=bool)
        matrix[self.root_from, self.root_to] = True
        return matrix

    @cached_property
    def parts(self) -> npt.NDArray[np.int64]:
        """The strongly connected part (N,) of each clip; 0 is the largest one."""
        from scipy.sparse.csgraph import connected_components

        count, part = connected_components(self.joined, directed=True, connection="strong")
        order = np.argsort(-np.bincount(part, minlength=count), kind="stable")
        return np.argsort(order)[part]

    @cached_property
    def exits(self) -> Indices:
        """The last frame (N,) at which a motion can leave each clip and still go on; −1: none.

        Nothing leads on from the frames behind it.
        """
        cuts = self.cuts
        alive = np.ones(len(cuts), dtype=bool)
        while True:
            exits = np.full(len(self.names), -1, dtype=np.int32)
            np.maximum.at(exits, cuts.from_clip[alive], cuts.i[alive])
            still = alive & (cuts.j < exits[cuts.to_clip])
            if still.sum() == alive.sum():
                return exits
            alive = still

    def leads_on(self, clip: int, frame: int) -> bool:
        """Whether a motion at that frame can go on for ever."""
        return bool(frame <= self.exits[clip])
