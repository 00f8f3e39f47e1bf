"""One static camera that holds every pose of every clip of a group."""

from dataclasses import dataclass

import numpy as np

from stimuli.errors import InputError
from stimuli.render.appearance import Appearance
from stimuli.render.shapes import Floats
from stimuli.ties import first_least

VIEWS = {  # name: (angle of the view's line from the heading, side of the azimuth, its say)
    "front-left": (0.0, 1.0, 1.3),
    "front-right": (0.0, -1.0, 1.3),
    "behind-left": (np.pi, -1.0, 1.0),
    "behind-right": (np.pi, 1.0, 1.0),
}
DECIMALS = 4  # of a metre, that a camera's place is rounded to
AS_LARGE = 1e-6  # of a metre's inverse: views that show a figure as large but for rounding
NEAREST = 0.3  # metres between the camera and the nearest point


@dataclass(frozen=True)
class Camera:
    """A perspective camera; it looks along its −Z axis, +X right and +Y up."""

    position: tuple[float, float, float]  # metres
    yaw: float  # radians: it stands at (sin yaw, ·, cos yaw) from what it sees
    elevation: float  # radians above level
    field_of_view: float  # radians, vertical

    @property
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

    def project(self, points: Floats, width: int, height: int) -> tuple[Floats, Floats]:
        """Pixels (..., 2) of points (..., 3), from the top left, and depths (...,) in metres."""
        local = (points - np.array(self.position)) @ self.axes
        depth = -local[..., 2]
        focal = height / 2 / np.tan(self.field_of_view / 2)
        centre = np.array([width / 2, height / 2])
        return centre + focal * local[..., :2] / depth[..., None] * [1, -1], depth


def view_axes(yaw: float, elevation: float) -> Floats:
    """(3, 3) right, up and backward directions, as columns, of a level camera lifted and tilted."""
    back = np.array(
        [np.sin(yaw) * np.cos(elevation), np.sin(elevation), np.cos(yaw) * np.cos(elevation)]
    )
    right = np.array([np.cos(yaw), 0.0, -np.sin(yaw)])
    return np.stack([right, np.cross(back, right), back], axis=-1)


def choose_camera(
    points: Floats, heading: float, at: Floats, look: Appearance, around: float = 0.0
) -> Camera:
    """The camera of the look's view, which holds all `points` (..., 3) and what is `around` them.

    The best view shows the figure at `at` (3,) as large as may be. InputError for an unknown view.
    """
    names = tuple(VIEWS) if look.view == "best" else (look.view,)
    if unknown := set(names) - set(VIEWS):
        raise InputError(f"view: expected best, {', '.join(VIEWS)}; found {unknown.pop()!r}.")
    azimuth = np.radians(look.azimuth)

    def seen(name: str) -> tuple[float, Camera]:
        line, side, say = VIEWS[name]
        camera = fit_camera(points, heading + line + side * azimuth, look, around)
        return say / float(camera.project(at, look.width, look.height)[1]), camera

    candidates = [seen(name) for name in names]
    return candidates[first_least([-say for say, _ in candidates], AS_LARGE)][1]


def fit_camera(points: Floats, yaw: float, look: Appearance, around: float = 0.0) -> Camera:
    """The nearest camera at an azimuth of `yaw` radians that holds all `points` (..., 3).

    Balls of radius `around` metres about the points are held too.

    In the camera's axes a point is in frame when |x − cx| ≤ t (cz − z), t the tangent of half the
    horizontal angle: two linear bounds on (cx, cz), so that cz and the middle of cx follow at
    once; likewise for the vertical.
    """
    elevation = np.radians(look.elevation)
    axes = view_axes(yaw, elevation)
    local = axes.T.astype(points.dtype) @ points.reshape(-1, 3).T
    tangent = np.tan(np.radians(look.field_of_view) / 2) * (1 - 2 * look.margin)
    centres, backs = [], []
    for axis, slope in ((0, tangent * look.width / look.height), (1, tangent)):
        ball = around * np.hypot(1.0, slope)
        upper = float(np.max(local[axis] + slope * local[2])) + ball
        lower = float(np.max(slope * local[2] - local[axis])) + ball
        centres.append((upper - lower) / 2)
        backs.append((upper + lower) / 2 / slope)
    back = max(*backs, float(local[2].max()) + NEAREST)
    place = axes @ np.array([*centres, back])
    x, y, z = (float(v) for v in np.round(place, DECIMALS))
    turn = round(float(np.arctan2(np.sin(yaw), np.cos(yaw))), 4)
    return Camera(
        (x, y, z), turn, round(float(elevation), 4), float(np.radians(look.field_of_view))
    )
