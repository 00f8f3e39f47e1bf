"""Poses as points, the geodesic distance between them, and the graph of the nearest.

The distance of two poses is `√Σ θ²` over all joints but the root, θ the geodesic distance of their
rotations (Wang 2005, II.3.2; VII.2 has "the distance metric proposed in Chapter 2"), half-angle
radians.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from stimuli.errors import InputError
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.transition.distance import check_pair, squared_angles

NEIGHBOURS = 7  # of a frame (VII.2)
_ROWS = 512  # frames whose distances to all others are held at once
_TINY = 1e-9  # distance of equal poses: a sparse matrix holds no zeros


def pose_rotations(motions: Sequence[Motion]) -> Array:
    """Rotations (N, J − 1, 4) of all frames of motions of one hierarchy, without the root's."""
    for other in motions[1:]:
        check_pair(motions[0], other)
    return np.concatenate([motion.rotations[:, 1:] for motion in motions])


def pose_distances(p: Array, q: Array) -> Array:
    """Distances (N, M), half-angle radians, of poses (N, J, 4) and (M, J, 4)."""
    squares = np.asarray(squared_angles(p, q, np.ones(p.shape[1])), dtype=float)
    return np.sqrt(squares, out=squares)


def nearest_frames(poses: Array, count: int) -> tuple[np.ndarray, Array]:
    """The `count` nearest other frames of each (N, count), nearest first, and how far (N, count).

    No more than `_ROWS` rows of the distance matrix are held at once.
    """
    found = np.empty((len(poses), count), dtype=np.int64)
    far = np.empty((len(poses), count))
    for first in range(0, len(poses), _ROWS):
        rows = slice(first, min(first + _ROWS, len(poses)))
        found[rows], far[rows] = nearest_of(pose_distances(poses[rows], poses), count, first)
    return found, far


def nearest_of(distances: Array, count: int, first: int = 0) -> tuple[np.ndarray, Array]:
    """The nearest of rows (R, N) of a distance matrix that begin with row `first`, and how far."""
    own = np.arange(len(distances))
    distances[own, own + first] = np.inf
    few = np.sort(np.argpartition(distances, count - 1, axis=1)[:, :count], axis=1)
    far = np.take_along_axis(distances, few, axis=1)
    order = np.argsort(far, axis=1, kind="stable")
    return np.take_along_axis(few, order, axis=1), np.take_along_axis(far, order, axis=1)


def neighbour_graph(found: np.ndarray, far: Array) -> Any:
    """The sparse graph (N, N) of each frame's neighbours, to be read without directions."""
    from scipy.sparse import csr_array

    count = found.shape[1]
    ends = np.arange(0, found.size + 1, count)
    return csr_array((np.maximum(far, _TINY).ravel(), found.ravel(), ends), shape=(len(found),) * 2)


def check_neighbours(count: int, frames: int) -> None:
    """InputError unless so many frames can have so many neighbours."""
    if not 1 <= count < frames:
        raise InputError(
            f"embedding: expected from 1 to {frames - 1} neighbours of each of {frames} frames, "
            f"found {count}.\nGive --neighbours, or longer clips."
        )


def check_whole(graph: Any, poses: Array, count: int, names: Sequence[str]) -> None:
    """InputError unless the graph hangs together; it names the pieces and what would join them.

    `names` (N,) are what its frames are called.
    """
    from scipy.sparse.csgraph import connected_components

    pieces, labels = connected_components(graph, directed=False)
    if pieces == 1:
        return
    sizes = np.bincount(labels)
    order = np.argsort(-sizes, kind="stable")
    told = [f"{sizes[p]} frames, {_spans(np.flatnonzero(labels == p), names)}" for p in order[:4]]
    more = f"; and {pieces - 4} smaller" if pieces > 4 else ""
    gaps = [_gap(poses, labels == p, names) for p in order[1:4]]
    raise InputError(
        f"embedding: expected a neighbourhood graph in one piece, found {pieces} pieces with "
        f"{count} neighbours: {'; '.join(told)}{more}; nearest to the rest: {', '.join(gaps)}.\n"
        f"Give --neighbours {_joining(poses, count)}, the fewest that join them, or other clips."
    )


def _spans(frames: np.ndarray, names: Sequence[str]) -> str:
    """The runs of some frames, the first three of them."""
    parts = np.split(frames, np.flatnonzero(np.diff(frames) > 1) + 1)
    told = [names[p[0]] if len(p) == 1 else f"{names[p[0]]} to {names[p[-1]]}" for p in parts[:3]]
    return ", ".join(told) + (f" and {len(parts) - 3} more runs" if len(parts) > 3 else "")


def _gap(poses: Array, inside: np.ndarray, names: Sequence[str]) -> str:
    """The two nearest frames inside and outside of a piece, and how far apart they are."""
    ours, others = np.flatnonzero(inside), np.flatnonzero(~inside)
    distances = pose_distances(poses[ours], poses[others])
    a, b = np.unravel_index(int(np.argmin(distances)), distances.shape)
    return f"{names[ours[a]]} and {names[others[b]]} ({distances[a, b]:.2f} rad)"


def _joining(poses: Array, count: int) -> int:
    """The least number of neighbours that joins all frames."""
    from scipy.sparse.csgraph import connected_components

    def joined(n: int) -> bool:
        part = neighbour_graph(found[:, :n], far[:, :n])
        return bool(connected_components(part, directed=False)[0] == 1)

    most = len(poses) - 1
    reach = min(2 * count, most)
    found, far = nearest_frames(poses, reach)
    while not joined(reach):
        count, reach = reach, min(2 * reach, most)
        found, far = nearest_frames(poses, reach)
    low, high = count + 1, reach
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if joined(middle) else (middle + 1, high)
    return low
