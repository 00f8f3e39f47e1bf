"""Skin of a single part: rings swept along its axis, closed by rounded ends."""

import numpy as np
from numpy.typing import NDArray

from stimuli.render.shapes import DENSE, Floats, Part

FACETS = 20
MOST_RINGS, RING_GAP = 14, 0.02  # along the axis, metres apart at most
CAP_RINGS = 5


def loft(part: Part) -> tuple[Floats, NDArray[np.int32], Floats]:
    """Vertices (V, 3), faces (T, 3) seen from outside, and each vertex's place (V,) on the axis."""
    # a ball has one ring about its middle: two in one place would share no face, and show a seam
    rings = int(np.clip(np.ceil(part.length / RING_GAP), 1, MOST_RINGS))
    steps = np.linspace(0, np.pi / 2, CAP_RINGS + 1)[:-1]
    place = np.concatenate([np.zeros(CAP_RINGS), np.linspace(0, 1, rings), np.ones(CAP_RINGS)])
    scale = np.concatenate([np.sin(steps), np.ones(rings), np.sin(steps)[::-1]])
    beyond = np.concatenate(
        [-part.caps[0] * np.cos(steps), np.zeros(rings), part.caps[1] * np.cos(steps)[::-1]]
    )
    scale[[0, -1]] = 1e-3  # a pole is a tiny ring: every row has the same number of vertices
    stations = np.linspace(0, 1, DENSE)
    width, depth, shift = (
        np.interp(place, stations, curve) for curve in (part.widths, part.depths, part.shift)
    )
    angle = np.linspace(0, 2 * np.pi, FACETS, endpoint=False)
    local = np.stack(
        np.broadcast_arrays(
            (scale * width)[:, None] * np.sin(angle),
            (place * part.length + beyond)[:, None],
            shift[:, None] + (scale * depth)[:, None] * np.cos(angle),
        ),
        axis=-1,
    ).reshape(-1, 3)
    points = part.start + local @ part.frame
    if part.floor is not None:
        points[:, 1] = np.maximum(points[:, 1], part.floor)
    return points, _tube(len(place)), np.repeat(place, FACETS)


def _tube(rows: int) -> NDArray[np.int32]:
    """(T, 3) faces between neighbouring rings of a tube of `rows` rings."""
    row, side = np.meshgrid(np.arange(rows - 1), np.arange(FACETS), indexing="ij")
    here = (row * FACETS + side).ravel()
    right = (row * FACETS + (side + 1) % FACETS).ravel()
    above, across = here + FACETS, right + FACETS
    faces = np.concatenate(
        [np.stack([here, right, across], axis=-1), np.stack([here, across, above], axis=-1)]
    )
    return faces.astype(np.int32)
