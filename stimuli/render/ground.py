"""The ground: a soft shadow where the body comes near it, and a faint grid that lies still.

Both fade out, so that the picture is the exact background outside them: the floor has no horizon.
The shadow is what the body's points, spheres of light kept off, leave of an even sky: a sum of
Gaussians on the floor, the wider and fainter the higher its point, so that two matrices of one
row a point make the whole picture of it.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stimuli.render.shapes import Floats

SHADOW_CELLS = 64  # of the shadow's picture, each way
SHADOW_SPAN = 2.4  # metres that it covers
DARKEST = 0.55  # of the background's light, that a foot on the floor keeps off
AT_FLOOR, SPREAD = 0.035, 0.50  # metres: SD of a point's shadow on the floor, and what height adds
FAINTER = 0.13  # metres of height by which a point's shadow is e times fainter
OF_A_POINT = 0.19  # how much one point on the floor keeps off
UNSEEN = 0.004  # shadows below this are none: under half a level of 128
SPACING = 0.5  # metres between lines
LINE = 1.5 / 720  # of the picture's height, their width
LINE_DARK = 0.16  # of the background's light, that a line keeps off
CLEAR, GONE = 0.4, 1.7  # metres from the body where the grid begins to fade, and is no more
PIECES = 4  # of each half of a line, for its fading

GROUNDS: Mapping[str, tuple[str, ...]] = {
    "none": (),
    "shadow": ("shadow",),
    "grid": ("grid", "shadow"),
}


@dataclass(frozen=True, eq=False)
class GroundMotion:
    """What a clip's ground is darkened by: points of the body, and where the floor is."""

    casters: NDArray[np.float32]  # (F, C, 3)
    middles: Floats  # (F, 2) x and z that the ground is drawn about
    floor: float


def shadow(points: Floats, floor: float, middle: Floats) -> NDArray[np.uint8]:
    """(SHADOW_CELLS, SHADOW_CELLS) how dark the floor is under points (C, 3), 255 being DARKEST.

    Rows go along z, columns along x, over a square of SHADOW_SPAN metres about `middle` (2,); its
    edge is never dark.
    """
    height = np.maximum(points[:, 1] - floor, 0.0)
    deviation = AT_FLOOR + SPREAD * height
    weight = OF_A_POINT * np.exp(-height / FAINTER) * (AT_FLOOR / deviation) ** 0.5
    places = (np.arange(SHADOW_CELLS) + 0.5) / SHADOW_CELLS * SHADOW_SPAN - SHADOW_SPAN / 2
    x, z = (
        np.exp(-0.5 * ((places - (points[:, [axis]] - at)) / deviation[:, None]) ** 2)
        for axis, at in ((0, middle[0]), (2, middle[1]))
    )
    dark = 1.0 - np.exp(-((weight[:, None] * z).T @ x))
    edge = np.minimum(1.0, (SHADOW_SPAN / 2 - np.abs(places)) / 0.3)
    dark = np.maximum(dark * edge * edge[:, None] - UNSEEN, 0.0)
    return np.rint(np.minimum(dark, 1.0) * 255).astype(np.uint8)


def lattice() -> NDArray[np.float32]:
    """(N, 5) corners of thin triangles along the lines of a grid about the origin.

    Each has x and z of its place on the line, the line's direction, and the side of it, −1 or 1.
    """
    reach = int(np.ceil(GONE / SPACING)) + 1
    at = np.arange(-reach, reach + 1) * SPACING
    along = np.linspace(-reach, reach, 2 * PIECES + 1) * SPACING
    across, place = (grid.ravel() for grid in np.meshgrid(at, along[:-1], indexing="ij"))
    step = along[1] - along[0]
    near = np.hypot(across, place + step / 2) < GONE + step / 2 + SPACING * np.sqrt(0.5)
    across, place = across[near], place[near]
    rows = []
    for end, side in ((0, -1), (0, 1), (1, 1), (0, -1), (1, 1), (1, -1)):
        here = place + end * step
        one, none = np.ones_like(here), np.zeros_like(here)
        rows.append(
            np.stack(
                [
                    np.stack([across, here, none, one, side * one], axis=-1),
                    np.stack([here, across, one, none, side * one], axis=-1),
                ]
            )
        )
    return np.stack(rows, axis=2).reshape(-1, 5).astype(np.float32)


def darkened(dark: NDArray[np.uint8]) -> tuple[int, int, int, int] | None:
    """First and last column, first and last row (those after) that are dark at all."""
    rows, columns = np.flatnonzero(dark.any(axis=1)), np.flatnonzero(dark.any(axis=0))
    if not len(rows):
        return None
    return int(columns[0]), int(columns[-1]) + 1, int(rows[0]), int(rows[-1]) + 1


def crossing(middle: Floats) -> Floats:
    """(2,) the crossing of lines nearest to a place; they lie at whole multiples of SPACING."""
    return np.asarray(np.round(middle / SPACING) * SPACING)
