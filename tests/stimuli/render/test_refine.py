"""Meshes made finer: closed as before, the same solid, and only where they were marked."""

from collections import Counter

import numpy as np
import pytest

from stimuli.render.refine import edges_of, split_edges

CORNERS = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], dtype=float)
FACES = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]], dtype=np.int32)


def volume(points: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = (points[faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


@pytest.mark.parametrize("marks", range(64))
def test_every_way_to_mark_a_tetrahedron_leaves_it_closed_and_whole(marks: int) -> None:
    edges, own = edges_of(FACES)
    marked = np.array([bool(marks >> k & 1) for k in range(6)])
    points, faces = split_edges(CORNERS, FACES, edges, own, marked)
    assert len(points) == 4 + marked.sum()
    assert len(faces) == 4 + 2 * marked.sum()  # as many as Euler has for a sphere
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    directed = Counter(map(tuple, sides.tolist()))
    assert set(directed.values()) == {1}
    assert all((b, a) in directed for a, b in directed)
    assert volume(points, faces) == pytest.approx(volume(CORNERS, FACES))


def test_edges_lie_after_the_corners_of_their_faces() -> None:
    edges, own = edges_of(FACES)
    assert len(edges) == 6
    for face, sides in zip(FACES, own, strict=True):
        for corner in range(3):
            assert set(edges[sides[corner]]) == {face[corner], face[(corner + 1) % 3]}
