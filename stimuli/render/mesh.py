"""What is known of a triangle mesh without the field it came from."""

import numpy as np
from numpy.typing import NDArray

from stimuli.render.shapes import Floats

Faces = NDArray[np.int32]


def vertex_normals(points: Floats, faces: Faces) -> Floats:
    """(V, 3) unit normals: the area-weighted mean of the faces around each vertex."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    across = np.tile(np.cross(b - a, c - a), (3, 1))
    normals = _gathered(faces.T.ravel(), across, len(points))
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)


def neighbour_mean(values: Floats, faces: Faces) -> Floats:
    """(V, n) mean of `values` (V, n) over each vertex's neighbours on a closed mesh."""
    here = faces[:, [0, 1, 2]].T.ravel()
    there = faces[:, [1, 2, 0]].T.ravel()
    count = np.bincount(here, minlength=len(values))
    return _gathered(here, values[there], len(values)) / np.maximum(count, 1)[:, None]


def _gathered(rows: NDArray[np.integer], values: Floats, size: int) -> Floats:
    """(size, n) sums of the `values` (N, n) that belong to each row."""
    columns = [np.bincount(rows, weights=column, minlength=size) for column in values.T]
    return np.stack(columns, axis=-1)
