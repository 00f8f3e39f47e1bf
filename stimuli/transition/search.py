"""The best transition points of a whole library, block by block, in bounded memory.

The matrix of 10⁵ by 10⁵ frames would take forty gigabytes in single precision. Blocks of it are
computed with a border of one frame, their local minima found, and the cheapest kept.
"""

import heapq
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.ties import ROUNDING, ranks
from stimuli.transition.distance import (
    MANY,
    check_pair,
    exact_angles,
    joint_rotations,
    velocity_features,
)
from stimuli.transition.kernel import fused_angles
from stimuli.transition.points import TRIVIAL
from stimuli.transition.weights import Weights, weighted_joints

SPARE = 32  # points more than wanted that are kept, since equal ones are put in order at the end
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
    features: Array  # (N, D) whose squared differences are the rest of the cost
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
    trivial: int = TRIVIAL,
    block: int = BLOCK,
    progress: Callable[[int], None] | None = None,
) -> list[Found]:
    """The `count` cheapest local minima of the cost from any motion to any other, cheapest first.

    `before` frames must lie before i and `after` behind j. Where a motion meets itself, points
    within `trivial` frames of the diagonal are left out. `progress` is told how many blocks of
    `blocks(...)` are done. Memory goes with the frames and with one block.

    Points of one cost but for rounding stand in the order of their places. Which cell of several
    that are level is the least is found in single precision where there are many: to 1e-5, and the
    same on one machine alone.
    """
    check = [*from_motions, *to_motions]
    for other in check[1:]:
        check_pair(check[0], other)
    level = float(from_motions[0].root[:, 1].mean())
    rows = _gathered(from_motions, weights, velocity_weight, level, lambda m: (before, len(m)))
    columns = _gathered(to_motions, weights, velocity_weight, level, lambda m: (0, len(m) - after))
    scale = weighted_joints(check[0].skeleton, weights)[1]
    same = np.array([[a.same_as(b) for b in to_motions] for a in from_motions])
    kept = count + SPARE
    best: list[tuple[float, tuple[int, int]]] = []  # a heap of the cheapest, the dearest on top
    for done, (top, left) in enumerate(_corners(len(rows.frame), len(columns.frame), block), 1):
        cost, corner = _block(rows, columns, top, left, block, scale)
        if len(best) < kept:  # a hundredth of a block is likely to hold as many as are wanted
            limits = [float(np.quantile(cost[::7, ::7], 0.01)), np.inf]
        else:
            limits = [-best[0][0]]
        for limit in limits:
            cells = _below(cost, limit, top - corner[0], left - corner[1], block)
            cells = cells[_sound(rows, columns, cells + np.array(corner), same, trivial)]
            cells = cells[_are_minima(cost, cells, rows, columns, corner)]
            if len(cells) >= kept:
                break
        _keep(best, kept, cost[tuple(cells.T)], cells + np.array(corner))
        if progress:
            progress(done)
    places = np.array([place for _, place in best]).reshape(-1, 2).T
    costs = _costs(rows, columns, places[0], places[1], scale)
    levels = ranks(costs.tolist())
    order = sorted(range(len(best)), key=lambda n: (levels[n], best[n][1]))[:count]
    return [
        Found(
            float(costs[n]), int(rows.motion[r]), int(rows.frame[r]),
            int(columns.motion[c]), int(columns.frame[c]),
        )
        for n, (r, c) in ((n, best[n][1]) for n in order)
    ]  # fmt: skip


def _costs(rows: _Frames, columns: _Frames, r: np.ndarray, c: np.ndarray, weights: Array) -> Array:
    """The cost of some cells (N,), each by itself and exact."""
    dots = np.abs(np.vecdot(rows.rotations[r], columns.rotations[c]))
    angles = np.square(np.arccos(np.minimum(dots, 1.0))) @ weights
    apart = np.square(rows.features[r] - columns.features[c]).sum(axis=1)
    return np.asarray(angles + apart)


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
    velocity_weight: float,
    level: float,
    room: Callable[[Motion], tuple[int, int]],
) -> _Frames:
    """The frames of some motions; heights count from `level`, since small squares round little."""
    joints, scale = weighted_joints(motions[0].skeleton, weights)
    allowed = []
    for motion in motions:
        first, last = room(motion)
        frames = np.arange(len(motion))
        allowed.append((frames >= first) & (frames < last))
    return _Frames(
        np.concatenate([joint_rotations(m, joints) for m in motions]),
        np.concatenate([_features(m, joints, scale, velocity_weight, level) for m in motions]),
        np.concatenate([np.full(len(m), k) for k, m in enumerate(motions)]),
        np.concatenate([np.arange(len(m)) for m in motions]),
        np.concatenate(allowed),
    )


def _features(
    motion: Motion, joints: list[int], scale: Array, velocity_weight: float, level: float
) -> Array:
    velocities = np.sqrt(velocity_weight) * velocity_features(motion, joints, scale)
    return np.column_stack([motion.root[:, 1] - level, velocities])


def _block(
    rows: _Frames, columns: _Frames, top: int, left: int, block: int, scale: Array
) -> tuple[npt.NDArray[np.floating], tuple[int, int]]:
    """The cost of a block with a border of one frame, and the place of its first cell."""
    r0, c0 = max(top - 1, 0), max(left - 1, 0)
    r, c = slice(r0, top + block + 1), slice(c0, left + block + 1)
    whole = len(rows.frame) * len(columns.frame) * len(scale)
    angles = fused_angles if whole > MANY else exact_angles
    cost = angles(rows.rotations[r], columns.rotations[c], scale)
    return _with_squares(cost, rows.features[r], columns.features[c]), (r0, c0)


def _with_squares(cost: npt.NDArray[Any], x: Array, y: Array) -> npt.NDArray[Any]:
    """`cost` (N, M) with ‖x_i − y_j‖² added in its place, to the rounding of its type.

    x² − 2xy + y² is one product of matrices, and BLAS adds it to what is there: passing over a
    block again and again takes longer than its distances.
    """
    from scipy.linalg import get_blas_funcs

    left = np.column_stack([x, np.square(x).sum(axis=1), np.ones(len(x))])
    right = np.column_stack([-2 * y, np.ones(len(y)), np.square(y).sum(axis=1)])
    gemm = get_blas_funcs("gemm", dtype=cost.dtype)
    # BLAS goes down columns, so that our rows are its columns: everything is transposed
    factors = (right.astype(cost.dtype).T, left.astype(cost.dtype).T)
    return np.asarray(gemm(1.0, *factors, 1.0, cost.T, trans_a=True, overwrite_c=True).T)


def _keep(
    best: list[tuple[float, tuple[int, int]]], count: int, costs: Array, places: np.ndarray
) -> None:
    """Take those of some places (N, 2) into the heap `best` that are among the `count` cheapest."""
    for k in np.argsort(costs, kind="stable")[:count]:
        entry = (-float(costs[k]), (int(places[k, 0]), int(places[k, 1])))
        if len(best) < count:
            heapq.heappush(best, entry)
        elif entry[0] > best[0][0]:
            heapq.heapreplace(best, entry)


def _below(
    cost: npt.NDArray[np.floating], limit: float, top: int, left: int, block: int
) -> np.ndarray:
    """Cells (N, 2) below `limit` in the block itself, which starts at (top, left) of `cost`."""
    below = cost[top : top + block, left : left + block] < limit
    i, j = np.divmod(np.flatnonzero(below), below.shape[1])  # faster flat than in two dimensions
    return np.column_stack([i + top, j + left])


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
        cheaper = beside <= value + ROUNDING if (dr, dc) < (0, 0) else beside < value - ROUNDING
        minima &= ~(known & cheaper)
    return minima
