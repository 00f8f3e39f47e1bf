"""The body as one distance field, and its zero surface as a closed mesh.

Parts of a limb are joined smoothly one after the other, limbs then to the trunk, each with its
own radius. The surface is found by surface nets (one vertex in each cell that the surface
crosses, a quad across each crossed edge; Gibson 1998), then relaxed and put back on the field,
and made finer where it bends much from one point to the next: a face, hands, feet.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stimuli.render.mesh import Faces, neighbour_mean
from stimuli.render.refine import edges_of, split_edges
from stimuli.render.shapes import Floats, Part, bounds, distance, smooth_union

CELL = 0.018  # of the figure's height
ROUNDS = 4
_SPLITS = 2  # times that edges are split, each followed by as many rounds and one
BEND, _SHORT_EDGE = np.radians(42.0), 0.006  # an edge that bends more is split; of the height
RELAXING = 0.5
SWELLING = 0.6
_FAR = 0.10
BETWEEN_LIMBS = 0.009
# Axis: the parts that need a finer grid along it. Hands reach out to the sides, toes lie lowest and
# farthest ahead, so that few other cells become finer.
THIN: Mapping[int, tuple[str, ...]] = {0: ("hand",), 1: ("hand", "toes"), 2: ("toes",)}
_FARTHEST = 0.03  # metres that a point is put back at once
_STEP = 1e-3  # metres, of central differences
STENCIL = _STEP * np.array(
    [[0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
)


def body_distance(parts: Sequence[Part], points: Floats) -> Floats:
    """(N,) signed distance of points (N, 3) from the joined body; exact only within `_FAR`."""
    return _distances(parts, points, np.zeros((1, 3)))[0]


def _distances(parts: Sequence[Part], points: Floats, offsets: Floats) -> Floats:
    """(S, N) distances of points (N, 3) moved by each of a few small `offsets` (S, 3)."""
    limbs: dict[str, Floats] = {}
    for part in parts:
        low, high = bounds(part)
        beyond = np.maximum(np.maximum(low - points, points - high), 0.0)
        outside = np.sqrt(np.einsum("ni,ni->n", beyond, beyond))
        near = np.flatnonzero(outside < _FAR)
        gap = np.tile(outside, (len(offsets), 1))
        gap[:, near] = distance(part, points[near] + offsets[:, None])
        _add(limbs, part, gap, ...)
    return _joined(limbs, parts)


def grid_distance(parts: Sequence[Part], axes: Sequence[Floats]) -> Floats:
    """The distances at the corners of a rectilinear grid with ascending `axes`, three of them.

    Each part is looked at only around itself.
    """
    shape = tuple(len(axis) for axis in axes)
    limbs: dict[str, Floats] = {}
    for part in parts:
        if part.limb not in limbs:
            limbs[part.limb] = np.full(shape, _FAR)
        corners = zip(*bounds(part), axes, strict=True)
        box = tuple(
            slice(*np.searchsorted(axis, [least - _FAR, most + _FAR]))
            for least, most, axis in corners
        )
        grid = np.stack(
            np.meshgrid(*(axis[part] for axis, part in zip(axes, box, strict=True)), indexing="ij"),
            axis=-1,
        )
        _add(limbs, part, distance(part, grid), box)
    return _joined(limbs, parts)


def _add(limbs: dict[str, Floats], part: Part, gap: Floats, where: Any) -> None:
    """Join a part to the parts of its limb before it."""
    if part.limb in limbs:
        limb = limbs[part.limb]
        limb[where] = smooth_union(limb[where], gap, part.blend)
    else:
        limbs[part.limb] = gap


def _joined(limbs: dict[str, Floats], parts: Sequence[Part]) -> Floats:
    """The limbs joined to the trunk, each by the radius of its first part."""
    roots = {part.limb: part.blend for part in reversed(parts)}
    trunk = whole = limbs["trunk"]
    for limb, gap in limbs.items():
        if limb != "trunk":
            whole = smooth_union(whole, smooth_union(trunk, gap, roots[limb]), BETWEEN_LIMBS)
    return whole


def closed_mesh(parts: Sequence[Part]) -> tuple[Floats, Faces]:
    """Vertices (V, 3) on the body's skin and outward faces (T, 3), one closed surface."""
    ends = np.array([bounds(part) for part in parts])[..., 1]
    tall = float(ends[:, 1].max() - ends[:, 0].min())
    axes = [_grid_axis(parts, axis, CELL * tall) for axis in range(3)]
    cells, quads = surface_nets(grid_distance(parts, axes))
    points: Floats = np.stack(
        [np.interp(cells[:, k], np.arange(len(axis)), axis) for k, axis in enumerate(axes)], axis=-1
    )
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)
    points = _relaxed(parts, points, faces, ROUNDS)
    for finer in range(1, _SPLITS + 1):
        edges, own = edges_of(faces)
        one, other = np.moveaxis(outward(parts, points)[edges], 1, 0)
        long = np.linalg.norm(np.diff(points[edges], axis=1)[:, 0], axis=1) > _SHORT_EDGE * tall
        bent = np.einsum("ei,ei->e", one, other) < np.cos(BEND)
        points, faces = split_edges(points, faces, edges, own, bent & long)
        points = _relaxed(parts, points, faces, finer + 1)
    return _swollen(parts, points, faces), faces


def _relaxed(parts: Sequence[Part], points: Floats, faces: Faces, rounds: int) -> Floats:
    """Points moved towards their neighbours' middles and put back on the skin."""
    for _ in range(rounds):
        points = points + RELAXING * (neighbour_mean(points, faces) - points)
        points = _projected(parts, points)
    return points


def _swollen(parts: Sequence[Part], points: Floats, faces: Faces) -> Floats:
    """Points put outside the skin by as much as the faces' middles lie inside of it.

    Triangles with their corners on a round skin are chords of it: outlines would be too narrow by
    half a pixel. Between corners and middles, they are right on average.
    """
    sunk = -body_distance(parts, points[faces].mean(axis=1))
    corners = faces.T.ravel()
    count = np.bincount(corners, minlength=len(points))
    mean = np.bincount(corners, weights=np.tile(sunk, 3), minlength=len(points)) / count
    return points + SWELLING * mean[:, None] * outward(parts, points)


def _grid_axis(parts: Sequence[Part], axis: int, cell: float) -> Floats:
    """Ascending coordinates a cell apart over all parts, half a cell where a part is thin.

    Across they go both ways from the middle, so that the two sides of a body are alike and the
    gap between its legs is met.
    """
    ends = np.array([bounds(part) for part in parts])[..., axis]
    least, most = float(ends[:, 0].min()), float(ends[:, 1].max())
    thin = [
        (float(low) - cell, float(high) + cell)
        for (low, high), part in zip(ends, parts, strict=True)
        if part.name.endswith(THIN[axis])
    ]
    if axis:
        return _marched(least - 2 * cell, most + 2 * cell, cell, thin)
    there = _marched(0.0, most + 2 * cell, cell, thin)
    back = _marched(0.0, 2 * cell - least, cell, [(-high, -low) for low, high in thin])
    return np.concatenate([-back[:0:-1], there])


def _marched(start: float, end: float, cell: float, thin: Sequence[tuple[float, float]]) -> Floats:
    """Places from `start` to beyond `end`, a cell apart, half a cell within spans."""
    places = [start]
    while places[-1] < end:
        fine = any(low <= places[-1] < high for low, high in thin)
        places.append(places[-1] + (cell / 2 if fine else cell))
    return np.array(places)


def surface_nets(values: Floats) -> tuple[Floats, NDArray[np.intp]]:
    """Vertices (V, 3) in grid units and outward quads (Q, 4) of the zero surface of a grid."""
    inside = values < 0
    corner = np.stack(np.meshgrid(*[[0, 1]] * 3, indexing="ij"), -1).reshape(-1, 3)
    size = np.array(values.shape) - 1

    def at(offset: NDArray[np.intp], array: NDArray) -> NDArray:
        i, j, k = offset
        return array[i : i + size[0], j : j + size[1], k : k + size[2]]

    count = np.sum([at(offset, inside) for offset in corner], axis=0)
    crossed = (count > 0) & (count < 8)
    cells = np.argwhere(crossed)
    number = np.full(crossed.shape, -1)
    number[crossed] = np.arange(len(cells))
    return _cell_vertices(values, cells), _quads(inside, number)


def _cell_vertices(values: Floats, cells: NDArray[np.intp]) -> Floats:
    """(V, 3) the mean of the points where the surface crosses the edges of each cell."""
    total, count = np.zeros((len(cells), 3)), np.zeros(len(cells))
    for axis in range(3):
        others = [other for other in range(3) if other != axis]
        for a, b in ((0, 0), (0, 1), (1, 0), (1, 1)):
            start = np.zeros(3, dtype=int)
            start[others] = a, b
            first = cells + start
            second = first.copy()
            second[:, axis] += 1
            v0, v1 = values[tuple(first.T)], values[tuple(second.T)]
            crosses = (v0 < 0) != (v1 < 0)
            where = np.where(crosses, v0 / np.where(crosses, v0 - v1, 1.0), 0.0)
            point = first.astype(float)
            point[:, axis] += where
            total += point * crosses[:, None]
            count += crosses
    return total / count[:, None]


def _quads(inside: NDArray[np.bool_], number: NDArray[np.intp]) -> NDArray[np.intp]:
    """(Q, 4) vertices around each crossed grid edge, ordered to be seen from outside."""
    faces = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        first = np.moveaxis(inside, (axis, u, v), (0, 1, 2))
        cell = np.moveaxis(number, (axis, u, v), (0, 1, 2))
        leaving = first[:-1, 1:-1, 1:-1] & ~first[1:, 1:-1, 1:-1]
        entering = ~first[:-1, 1:-1, 1:-1] & first[1:, 1:-1, 1:-1]
        around = np.stack(
            [cell[:, :-1, :-1], cell[:, 1:, :-1], cell[:, 1:, 1:], cell[:, :-1, 1:]], axis=-1
        )
        faces += [around[leaving], around[entering][:, ::-1]]
    return np.concatenate(faces)


def outward(parts: Sequence[Part], points: Floats) -> Floats:
    """(N, 3) unit normals of the body's skin at points on it: the field's gradient."""
    _, slope = _gradient(parts, points)
    return slope / np.maximum(np.linalg.norm(slope, axis=1, keepdims=True), 1e-9)


def _projected(parts: Sequence[Part], points: Floats) -> Floats:
    """Points moved along the gradient onto the zero surface (one Newton step, bounded)."""
    gap, slope = _gradient(parts, points)
    steepness = np.maximum(np.einsum("ni,ni->n", slope, slope), 0.25)
    step = np.clip(gap / steepness, -_FARTHEST, _FARTHEST)
    return points - step[:, None] * slope


def _gradient(parts: Sequence[Part], points: Floats) -> tuple[Floats, Floats]:
    """(N,) distances of points and (N, 3) their gradients."""
    gaps = _distances(parts, points, STENCIL)
    slope = np.stack([gaps[1] - gaps[2], gaps[3] - gaps[4], gaps[5] - gaps[6]], axis=-1)
    return gaps[0], slope / (2 * _STEP)
