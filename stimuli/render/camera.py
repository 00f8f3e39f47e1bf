"""A perspective camera that stands, turns or goes along, and the frame it must hold things in."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stimuli.render.appearance import Appearance
from stimuli.render.shapes import Floats

DECIMALS = 4  # of a metre, that a camera's place is rounded to
NEAREST = 0.3  # metres between the camera and the nearest point


@dataclass(frozen=True)
class Camera:
    """A perspective camera; it looks along its −Z axis, +X right and +Y up.

    `moves` has for each frame of a clip how far it has gone (x, z in metres) from `position` and
    turned (radians) from `yaw`; a camera that stands has none.
    """

    position: tuple[float, float, float]  # metres
    yaw: float  # radians: it stands at (sin yaw, ·, cos yaw) from what it sees
    elevation: float  # radians above level
    field_of_view: float  # radians, vertical
    kind: str = "fixed"
    moves: tuple[tuple[float, float, float], ...] = ()

    def at(self, frame: int) -> "Camera":
        """The standing camera of a frame of the clip."""
        if not self.moves:
            return self
        x, z, turn = self.moves[frame]
        place = (self.position[0] + x, self.position[1], self.position[2] + z)
        return Camera(place, self.yaw + turn, self.elevation, self.field_of_view, self.kind)

    @cached_property
    def axes(self) -> Floats:
        """(3, 3) columns: the camera's right, up and backward directions in the world."""
        return view_axes(self.yaw, self.elevation)

    @property
    def pose(self) -> Floats:
        """(4, 4) camera to world."""
        pose = np.eye(4)
        pose[:3, :3] = self.axes
        pose[:3, 3] = self.position
        return pose

    def seen(self, points: Floats, frames: NDArray[np.integer] | None = None) -> Floats:
        """Points (..., 3) in the camera's axes, metres.

        A camera that moves takes the points (N, ..., 3) of N `frames`, or of all its frames.
        """
        if not self.moves:
            return np.asarray((points - np.array(self.position)) @ self.axes)
        moves = np.array(self.moves)[slice(None) if frames is None else frames]
        place = np.array(self.position) + np.stack(
            [moves[:, 0], np.zeros(len(moves)), moves[:, 1]], axis=-1
        )
        flat = points.reshape(len(points), -1, 3) - place[:, None].astype(points.dtype)
        if not moves[:, 2].any():
            return np.asarray((flat @ self.axes.astype(points.dtype)).reshape(points.shape))
        axes = view_axes(self.yaw + moves[:, 2], self.elevation)
        return np.asarray(np.einsum("npi,nij->npj", flat, axes).reshape(points.shape))

    def project(self, points: Floats, width: int, height: int) -> tuple[Floats, Floats]:
        """Pixels (..., 2) of points (..., 3), from the top left, and depths (...,) in metres.

        A camera that moves takes the points of all frames, (F, ..., 3).
        """
        local = self.seen(points)
        depth = -local[..., 2]
        focal = height / 2 / np.tan(self.field_of_view / 2)
        centre = np.array([width / 2, height / 2])
        return centre + focal * local[..., :2] / depth[..., None] * [1, -1], depth

    def size_of(
        self, height: float, at: Floats, frames: NDArray[np.integer] | None = None
    ) -> Floats:
        """(...,) the share of the picture's height that something upright at (..., 3) has.

        It is `height` metres high; places by `frames` as for `seen`.
        """
        depth = -self.seen(at, frames)[..., 2]
        upright = height * np.cos(self.elevation)
        return np.asarray(upright / (2 * depth * np.tan(self.field_of_view / 2)))


def view_axes(yaw: Floats | float, elevation: float) -> Floats:
    """(..., 3, 3) right, up and backward directions, as columns, of a level camera tilted."""
    sine, cosine, none = np.sin(yaw), np.cos(yaw), np.zeros_like(yaw)
    level = np.cos(elevation)
    back = np.stack([sine * level, none + np.sin(elevation), cosine * level], axis=-1)
    right = np.stack([cosine, none, -sine], axis=-1)
    return np.stack([right, np.cross(back, right), back], axis=-1)


@dataclass(frozen=True)
class Frame:
    """What a look leaves free in a picture: tangents of the half-angles within its margins."""

    across: float
    up: float
    half: float  # tangent of half the vertical angle, margins included

    @staticmethod
    def of(look: Appearance) -> "Frame":
        """The frame of a look whose width is known."""
        half = float(np.tan(np.radians(look.field_of_view) / 2))
        up = half * (1 - 2 * look.margin)
        return Frame(up * look.width / look.height, up, half)


def fit_camera(points: Floats, yaw: float, look: Appearance, around: float = 0.0) -> Camera:
    """The nearest camera at an azimuth of `yaw` radians that holds all `points` (N, P, 3).

    Balls of radius `around` metres about the points are held too, and the middle of what is seen
    in each of the N frames is in the picture's middle on average, to within `OFF_MIDDLE`.

    In the camera's axes a point is in frame when |x − cx| ≤ t (cz − z), t the tangent of half the
    horizontal angle: two linear bounds on (cx, cz), so that cz and the middle of cx follow at
    once; likewise for the vertical, where cy is moved until the figures stand in the middle.
    """
    elevation = np.radians(look.elevation)
    axes = view_axes(yaw, elevation)
    frame = Frame.of(look)
    local = points @ axes.astype(points.dtype)
    x, y, z = (local[..., axis] for axis in range(3))
    right, left = (float(np.max(frame.across * z + s * x)) for s in (1, -1))
    top, bottom = (float(np.max(frame.up * z + s * y)) for s in (1, -1))
    wide, high = (around * np.hypot(1.0, slope) for slope in (frame.across, frame.up))
    least = max((right + left) / 2 / frame.across + wide / frame.across, float(z.max()) + NEAREST)
    up = (top - bottom) / 2
    for _ in range(_ROUNDS):
        back = max(least, (max(top - up, bottom + up) + high) / frame.up)
        off = _off_middle(y, z, up, back, frame.half)
        if abs(off) <= OFF_MIDDLE:
            break
        up += (off - np.copysign(OFF_MIDDLE / 2, off)) * 2 * frame.half * (back - float(z.mean()))
    back = max(least, (max(top - up, bottom + up) + high) / frame.up)
    place = axes @ np.array([(right - left) / 2, up, back])
    return Camera(
        (round(float(place[0]), DECIMALS), round(float(place[1]), DECIMALS),
         round(float(place[2]), DECIMALS)),
        round(float(np.arctan2(np.sin(yaw), np.cos(yaw))), 4),
        round(float(elevation), 4), float(np.radians(look.field_of_view)),
    )  # fmt: skip


OFF_MIDDLE = 0.025  # of the picture's height
_ROUNDS = 8


def _off_middle(y: Floats, z: Floats, up: float, back: float, half: float) -> float:
    """How far above the middle figures (N, P) are on average, as a share of the height."""
    seen = (y - up) / (2 * half * (back - z))
    return float(np.mean(seen.max(axis=-1) + seen.min(axis=-1)) / 2)
