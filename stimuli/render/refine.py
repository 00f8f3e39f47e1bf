"""A mesh made finer where it bends: marked edges are split, and each face along them.

A face is split in two, three or four by how many of its edges are, so that the surface stays
closed (after Bank, Sherman and Weiser 1983).
"""

import numpy as np
from numpy.typing import NDArray

from stimuli.render.mesh import Faces
from stimuli.render.shapes import Floats

Numbers = NDArray[np.integer]


def edges_of(faces: Faces) -> tuple[Numbers, Numbers]:
    """(E, 2) the edges of a mesh, and (T, 3) which of them lie after each corner of a face."""
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges, place = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
    return edges, place.reshape(3, -1).T


def split_edges(
    points: Floats, faces: Faces, edges: Numbers, own: Numbers, marked: NDArray[np.bool_]
) -> tuple[Floats, Faces]:
    """Points (V', 3) and faces (T', 3) with a point in the middle of each edge `marked` (E,).

    `edges` and `own` are those of `edges_of`.
    """
    number = np.full(len(edges), -1)
    number[marked] = len(points) + np.arange(np.count_nonzero(marked))
    finer = np.concatenate([points, points[edges[marked]].mean(axis=1)])
    middles = number[own]
    split = middles >= 0
    count = split.sum(axis=1)

    def turned(many: int, first: Numbers) -> tuple[Numbers, ...]:
        """Corners a, b, c and middles ab, bc, ca of faces with so many, from corner `first` on."""
        chosen = count == many
        order = (first[chosen, None] + np.arange(3)) % 3
        at = (np.take_along_axis(rows[chosen], order, axis=1) for rows in (faces, middles))
        return tuple(np.concatenate(list(at), axis=1).T)

    pieces = [faces[count == 0]]
    a, b, c, ab, _, _ = turned(1, split.argmax(axis=1))
    pieces += _faces((a, ab, c), (ab, b, c))
    a, b, c, ab, bc, _ = turned(2, (~split).argmax(axis=1) + 1)
    pieces += _faces((ab, b, bc))
    across = np.linalg.norm(finer[a] - finer[bc], axis=1)
    short = across <= np.linalg.norm(finer[ab] - finer[c], axis=1)  # of the quad's two diagonals
    end, other = np.where(short, bc, c), np.where(short, a, ab)
    pieces += _faces((a, ab, end), (other, bc, c))
    a, b, c, ab, bc, ca = turned(3, np.zeros(len(faces), dtype=int))
    pieces += _faces((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
    return finer, np.concatenate(pieces).astype(np.int32)


def _faces(*corners: tuple[Numbers, Numbers, Numbers]) -> list[Numbers]:
    return [np.stack(each, axis=-1) for each in corners]
