"""A camera that stands and turns: the nearest place from which all is held while it turns."""

import numpy as np
from numpy.typing import NDArray

from stimuli.render.appearance import Appearance
from stimuli.render.camera import DECIMALS, OFF_MIDDLE, Camera, Frame
from stimuli.render.shapes import Floats

_HALVINGS = 9
_CENTRINGS = 3
FARTHEST = 80.0  # metres


def pan_camera(
    outlines: Floats,
    frames: NDArray[np.integer],
    path: Floats,
    yaw: float,
    look: Appearance,
    around: float = 0.0,
) -> Camera:
    """The nearest camera at an azimuth of `yaw` from the path's middle that holds all outlines.

    `outlines` (N, P, 3) are of the clip's `frames` (N,); the camera is turned to `path` (F, 2) at
    each. Found by halving the distance, as whatever is in frame stays so from further away.
    """
    low, high = 1.0, FARTHEST
    camera = _placed(outlines, frames, path, yaw, high, look)
    for _ in range(_HALVINGS):
        middle = np.sqrt(low * high)
        nearer = _placed(outlines, frames, path, yaw, float(middle), look)
        if _holds(nearer, outlines, frames, look, around):
            high, camera = float(middle), nearer
        else:
            low = float(middle)
    return camera


def _placed(
    outlines: Floats,
    frames: NDArray[np.integer],
    path: Floats,
    yaw: float,
    distance: float,
    look: Appearance,
) -> Camera:
    """The camera at a distance, as high as shows the figures in the middle on average."""
    centre = (path.min(axis=0) + path.max(axis=0)) / 2
    elevation = np.radians(look.elevation)
    place = centre + distance * np.cos(elevation) * np.array([np.sin(yaw), np.cos(yaw)])
    turned = np.unwrap(np.arctan2(*(place - path).T))
    moves = tuple((0.0, 0.0, round(float(turn - yaw), 5)) for turn in turned)
    height = float(outlines[..., 1].mean()) + distance * np.sin(elevation)
    half = Frame.of(look).half
    for _ in range(_CENTRINGS):
        camera = Camera(
            (round(float(place[0]), DECIMALS), round(height, DECIMALS),
             round(float(place[1]), DECIMALS)),
            round(float(yaw), 4), round(float(elevation), 4),
            float(np.radians(look.field_of_view)), "pan", moves,
        )  # fmt: skip
        seen = camera.seen(outlines, frames)
        depth = np.maximum(-seen[..., 2], 0.1)
        share = seen[..., 1] / (2 * half * depth)
        off = float(np.mean(share.max(axis=-1) + share.min(axis=-1)) / 2)
        if abs(off) <= OFF_MIDDLE / 2:
            break
        height += off * 2 * half * float(depth.mean())
    return camera


def _holds(
    camera: Camera, outlines: Floats, frames: NDArray[np.integer], look: Appearance, around: float
) -> bool:
    frame = Frame.of(look)
    seen = camera.seen(outlines, frames)
    depth = -seen[..., 2] - around
    return bool(
        np.all(depth > 0)
        and np.all(np.abs(seen[..., 0]) + around <= frame.across * depth)
        and np.all(np.abs(seen[..., 1]) + around <= frame.up * depth)
    )
