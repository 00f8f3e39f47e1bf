"""The body as one distance field, and its zero surface as a closed mesh.

Parts of a limb are joined smoothly one after the other, limbs then to the trunk, each with its
own radius. The surface is found by surface nets (one vertex in each cell that the surface
crosses, a quad across each crossed edge; Gibson 1998), then relaxed and put back on the field.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from stimuli.render.mesh import neighbour_mean
from stimuli.render.shapes import Floats, Part, bounds, distance, smooth_union

CELL = 0.016
ROUNDS = 4
RELAXING = 0.6
FAR = 0.12
BETWEEN_LIMBS = 0.006


def body_distance(parts: Sequence[Part], points: Floats) -> Floats:
    """(N,) signed distance of points (N, 3) from the joined body; exact only within `FAR`."""
    limbs: dict[str, Floats] = {}
    for part in parts:
        gap = _near_distance(part, points)
        before = limbs.get(part.limb)
        limbs[part.limb] = gap if before is None else smooth_union(before, gap, part.blend)
    trunk = limbs.pop("trunk")
    roots = {part.limb: part.blend for part in reversed(parts)}
    joined = [smooth_union(trunk, gap, roots[limb]) for limb, gap in limbs.items()]
    whole = trunk
    for gap in joined:
        whole = smooth_union(whole, gap, BETWEEN_LIMBS)
    return whole


def _near_distance(part: Part, points: Floats) -> Floats:
    """Distance where it is below `FAR`; the box's own distance, at least, elsewhere."""
    low, high = bounds(part)
    outside = np.maximum(np.maximum(low - points, points - high), 0.0)
    gap = np.sqrt(np.einsum("ni,ni->n", outside, outside))
    near = gap < FAR
    gap[near] = distance(part, points[near])
    return gap


def gradient(parts: Sequence[Part], points: Floats, step: float = 1e-3) -> Floats:
    """(N, 3) slope of the field by central differences: the outward normal near the skin."""
    slope = np.empty_like(points)
    for axis in range(3):
        shift = np.zeros(3)
        shift[axis] = step
        slope[:, axis] = body_distance(parts, points + shift) - body_distance(parts, points - shift)
    return slope / (2 * step)


def closed_mesh(parts: Sequence[Part], cell: float = CELL) -> tuple[Floats, NDArray[np.int32]]:
    """Vertices (V, 3) on the body's skin and outward faces (T, 3), one closed surface."""
    corners = [bounds(part) for part in parts]
    low = np.min([c[0] for c in corners], axis=0) - 2 * cell
    high = np.max([c[1] for c in corners], axis=0) + 2 * cell
    shape = np.ceil((high - low) / cell).astype(int) + 1
    grid = low + cell * np.stack(np.meshgrid(*(np.arange(n) for n in shape), indexing="ij"), -1)
    values = body_distance(parts, grid.reshape(-1, 3)).reshape(shape)
    cells, quads = surface_nets(values)
    points = low + cell * cells
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)
    for _ in range(ROUNDS):
        points = points + RELAXING * (neighbour_mean(points, faces) - points)
        points = _projected(parts, points)
    return points, faces


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


def _projected(parts: Sequence[Part], points: Floats) -> Floats:
    """Points moved along the gradient onto the zero surface (one Newton step, bounded)."""
    slope = gradient(parts, points)
    steepness = np.maximum(np.einsum("ni,ni->n", slope, slope), 0.25)
    step = np.clip(body_distance(parts, points) / steepness, -CELL, CELL)
    return points - step[:, None] * slope
