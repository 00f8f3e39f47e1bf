"""One static camera that holds every pose of every clip of a group."""

from dataclasses import dataclass, replace

import numpy as np

from stimuli.render.appearance import Appearance
from stimuli.render.shapes import Floats

THREE_QUARTER, FRONT = 35.0, 1.3
VIEWS = (
    (THREE_QUARTER, FRONT),
    (-THREE_QUARTER, FRONT),
    (180.0 - THREE_QUARTER, 1.0),
    (THREE_QUARTER - 180.0, 1.0),
)
DECIMALS = 4  # of a metre, that a camera's place is rounded to
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


def choose_camera(points: Floats, heading: float, at: Floats, look: Appearance) -> Camera:
    """A camera that holds all `points` (..., 3) with the figure at `at` (3,) as large as may be.

    Of the three-quarter views, left and right, the front has `FRONT` times the say of the back.
    """
    if look.azimuth is not None:
        return fit_camera(points, heading, look)

    def size(camera: Camera, weight: float) -> float:
        return weight / float(camera.project(at, look.width, look.height)[1])

    views = [
        (fit_camera(points, heading, replace(look, azimuth=azimuth)), weight)
        for azimuth, weight in VIEWS
    ]
    return max(views, key=lambda view: size(*view))[0]


def fit_camera(points: Floats, heading: float, look: Appearance) -> Camera:
    """The nearest camera at the look's angles from `heading` that holds all `points` (..., 3).

    In the camera's axes a point is in frame when |x − cx| ≤ t (cz − z), t the tangent of half the
    horizontal angle: two linear bounds on (cx, cz), so that cz and the middle of cx follow at
    once; likewise for the vertical.
    """
    yaw = heading + np.radians(THREE_QUARTER if look.azimuth is None else look.azimuth)
    elevation = np.radians(look.elevation)
    axes = view_axes(yaw, elevation)
    local = points.reshape(-1, 3) @ axes
    tangent = np.tan(np.radians(look.field_of_view) / 2) * (1 - 2 * look.margin)
    centres, backs = [], []
    for axis, slope in ((0, tangent * look.width / look.height), (1, tangent)):
        upper = np.max(local[:, axis] + slope * local[:, 2])
        lower = np.max(-local[:, axis] + slope * local[:, 2])
        centres.append((upper - lower) / 2)
        backs.append((upper + lower) / 2 / slope)
    back = max(*backs, float(local[:, 2].max()) + NEAREST)
    place = axes @ np.array([*centres, back])
    x, y, z = (float(v) for v in np.round(place, DECIMALS))
    turn = round(float(np.arctan2(np.sin(yaw), np.cos(yaw))), 4)
    return Camera(
        (x, y, z), turn, round(float(elevation), 4), float(np.radians(look.field_of_view))
    )
