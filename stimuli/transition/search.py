"""The best transition points of a whole library, block by block, in bounded memory.

The matrix of 10⁵ by 10⁵ frames would take forty gigabytes in single precision. Blocks of it are
computed with a border of one frame, their local minima found, and the cheapest kept.
"""

import heapq
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.transition.distance import (
    MANY,
    check_pair,
    exact_angles,
    joint_rotations,
    squared_euclidean,
    velocity_features,
)
from stimuli.transition.kernel import fused_angles
from stimuli.transition.weights import Weights, weighted_joints

BLOCK = 2048  # frames on a side: a block takes some hundred megabytes at the most


@dataclass(frozen=True)
class Found:
    """A transition point between two motions of a library, by their places in it."""

    cost: float
    from_motion: int
    i: int
    to_motion: int
    j: int


@dataclass(frozen=True, eq=False)
class _Frames:
    """All frames of some motions in a row, as the cost compares them."""

    rotations: Array
    heights: Array
    velocities: npt.NDArray[np.float32]
    motion: np.ndarray
    frame: np.ndarray
    allowed: np.ndarray


def search(
    from_motions: Sequence[Motion],
    to_motions: Sequence[Motion],
    *,
    count: int = 50,
    weights: str | Weights = "wang",
    velocity_weight: float = 1.0,
    before: int = 0,
    after: int = 0,
    trivial: int = 15,
    block: int = BLOCK,
    progress: Callable[[int], None] | None = None,
) -> list[Found]:
    """The `count` cheapest local minima of the cost from any motion to any other, cheapest first.

    `before` frames must lie before i and `after` behind j. Where a motion meets itself, points
    within `trivial` frames of the diagonal are left out. `progress` is told how many blocks of
    `blocks(...)` are done. Memory goes with the frames and with one block.
    """
    check = [*from_motions, *to_motions]
    for other in check[1:]:
        check_pair(check[0], other)
    rows = _gathered(from_motions, weights, lambda m: (before, len(m)))
    columns = _gathered(to_motions, weights, lambda m: (0, len(m) - after))
    scale = weighted_joints(check[0].skeleton, weights)[1]
    same = np.array([[a is b for b in to_motions] for a in from_motions])
    best: list[tuple[float, tuple[int, int]]] = []  # a heap of the cheapest, the dearest on top
    for done, (top, left) in enumerate(_corners(len(rows.frame), len(columns.frame), block), 1):
        cost, (r0, c0) = _block(rows, columns, top, left, block, scale, velocity_weight)
        inside = _interior(cost.shape, r0, c0, top, left, block)
        if len(best) < count:  # a hundredth of a block is likely to hold as many as are wanted
            limits = [float(np.quantile(cost[::7, ::7], 0.01)), np.inf]
        else:
            limits = [-best[0][0]]
        for limit in limits:
            cells = np.argwhere(inside & (cost < limit))
            cells = cells[_sound(rows, columns, cells + np.array([r0, c0]), same, trivial)]
            cells = cells[_are_minima(cost, cells, rows, columns, (r0, c0))]
            if len(cells) >= count:
                break
        values = cost[tuple(cells.T)]
        for k in np.argsort(values, kind="stable")[:count]:
            entry = (-float(values[k]), (r0 + int(cells[k, 0]), c0 + int(cells[k, 1])))
            if len(best) < count:
                heapq.heappush(best, entry)
            elif entry[0] > best[0][0]:
                heapq.heapreplace(best, entry)
        if progress:
            progress(done)
    return [
        Found(
            -negative, int(rows.motion[r]), int(rows.frame[r]),
            int(columns.motion[c]), int(columns.frame[c]),
        )
        for negative, (r, c) in sorted(best, key=lambda entry: (-entry[0], entry[1]))
    ]  # fmt: skip


def blocks(from_motions: Sequence[Motion], to_motions: Sequence[Motion], block: int = BLOCK) -> int:
    """How many blocks a search goes through."""
    sizes = (sum(len(m) for m in motions) for motions in (from_motions, to_motions))
    rows, columns = (-(-size // block) for size in sizes)
    return rows * columns


def _corners(rows: int, columns: int, block: int) -> Iterator[tuple[int, int]]:
    return ((r, c) for r in range(0, rows, block) for c in range(0, columns, block))


def _gathered(
    motions: Sequence[Motion],
    weights: str | Weights,
    room: Callable[[Motion], tuple[int, int]],
) -> _Frames:
    joints, scale = weighted_joints(motions[0].skeleton, weights)
    allowed = []
    for motion in motions:
        first, last = room(motion)
        frames = np.arange(len(motion))
        allowed.append((frames >= first) & (frames < last))
    return _Frames(
        np.concatenate([joint_rotations(m, joints) for m in motions]),
        np.concatenate([m.root[:, 1] for m in motions]),
        np.concatenate([velocity_features(m, joints, scale) for m in motions]).astype(np.float32),
        np.concatenate([np.full(len(m), k) for k, m in enumerate(motions)]),
        np.concatenate([np.arange(len(m)) for m in motions]),
        np.concatenate(allowed),
    )


def _block(
    rows: _Frames,
    columns: _Frames,
    top: int,
    left: int,
    block: int,
    scale: Array,
    velocity_weight: float,
) -> tuple[npt.NDArray[np.floating], tuple[int, int]]:
    """The cost of a block with a border of one frame, and the place of its first cell."""
    r0, c0 = max(top - 1, 0), max(left - 1, 0)
    r, c = slice(r0, top + block + 1), slice(c0, left + block + 1)
    whole = len(rows.frame) * len(columns.frame) * len(scale)
    angles = fused_angles if whole > MANY else exact_angles
    cost = angles(rows.rotations[r], columns.rotations[c], scale)
    cost += np.square(rows.heights[r, None] - columns.heights[None, c]).astype(cost.dtype)
    if velocity_weight:
        speeds = squared_euclidean(rows.velocities[r], columns.velocities[c])
        cost += np.float32(velocity_weight) * speeds
    return cost, (r0, c0)


def _interior(
    shape: tuple[int, ...], r0: int, c0: int, top: int, left: int, block: int
) -> np.ndarray:
    """The block itself without its border."""
    inside = np.zeros(shape, dtype=bool)
    inside[top - r0 : top - r0 + block, left - c0 : left - c0 + block] = True
    return inside


def _sound(
    rows: _Frames, columns: _Frames, places: np.ndarray, same: np.ndarray, trivial: int
) -> np.ndarray:
    """Which cells (N, 2) leave room on both sides and are no motion going on into itself."""
    r, c = places.T
    meets = same[rows.motion[r], columns.motion[c]]
    near = np.abs(rows.frame[r] - columns.frame[c]) <= trivial
    return np.asarray(rows.allowed[r] & columns.allowed[c] & ~(meets & near))


def _are_minima(
    cost: npt.NDArray[np.floating],
    cells: np.ndarray,
    rows: _Frames,
    columns: _Frames,
    corner: tuple[int, int],
) -> np.ndarray:
    """Which cells (N, 2) have no neighbour of the same two motions that is cheaper.

    Of two neighbours at one level the earlier one counts.
    """
    value = cost[tuple(cells.T)]
    minima = np.ones(len(cells), dtype=bool)
    for dr, dc in ((r, c) for r in (-1, 0, 1) for c in (-1, 0, 1) if (r, c) != (0, 0)):
        r, c = (cells + np.array([dr, dc])).T
        known = (r >= 0) & (r < cost.shape[0]) & (c >= 0) & (c < cost.shape[1])
        r, c = np.where(known, r, cells[:, 0]), np.where(known, c, cells[:, 1])
        known &= rows.motion[r + corner[0]] == rows.motion[cells[:, 0] + corner[0]]
        known &= columns.motion[c + corner[1]] == columns.motion[cells[:, 1] + corner[1]]
        beside = cost[r, c]
        cheaper = beside <= value if (dr, dc) < (0, 0) else beside < value
        minima &= ~(known & cheaper)
    return minima
