"""The solids a body is made of: tapered elliptic capsules with smooth radius profiles.

A part has an axis from `start` to `end`, half-widths and half-depths at evenly spaced stations
along it, and rounded ends. It can be asked how far a point is from its skin, and which bones
carry it at which point of its axis.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating]
DENSE = 129
SOLE_EDGE = 0.010  # metres, how far the edge of a cut is rounded


@dataclass(frozen=True, eq=False)
class Part:
    """A tapered elliptic capsule; lengths in metres, in the reference pose."""

    name: str
    start: Floats  # (3,)
    end: Floats  # (3,)
    side: Floats  # (3,) unit, the direction of the half-widths
    widths: Floats  # (DENSE,) half-widths from start to end
    depths: Floats  # (DENSE,) half-depths
    shift: Floats  # (DENSE,) how far the axis is moved along the depth direction
    caps: tuple[float, float]  # lengths of the rounded ends
    bones: tuple[tuple[float, str], ...]  # (place on the axis 0..1, bone), places ascending
    limb: str  # parts of a limb are joined first, then the limb to the trunk
    blend: float  # how far the crease with what it is joined to is rounded, metres
    floor: float | None = None  # height of a plane that cuts the part from below (a sole)

    @property
    def length(self) -> float:
        """Length of the axis, metres."""
        return float(np.linalg.norm(self.end - self.start))

    @property
    def frame(self) -> Floats:
        """(3, 3) rows: side, axis, depth; orthonormal and right-handed."""
        axis = (self.end - self.start) / self.length
        side = self.side - axis * (self.side @ axis)
        side = side / np.linalg.norm(side)
        return np.stack([side, axis, np.cross(side, axis)])


def profile(values: tuple[float, ...], scale: float = 1.0) -> Floats:
    """(DENSE,) a smooth curve through evenly spaced `values`: a cubic spline.

    It is flat at both ends, where a rounded end goes on from it: any slope there would be a
    crease. Its bend changes without a jump, as a jump would show in the shading as a ridge.
    """
    from scipy.interpolate import CubicSpline

    knots = np.asarray(values, dtype=float) * scale
    if len(knots) == 1:
        return np.full(DENSE, knots[0])
    spline = CubicSpline(np.linspace(0, 1, len(knots)), knots, bc_type="clamped")
    return np.asarray(spline(np.linspace(0, 1, DENSE)))


def place_on_axis(part: Part, points: Floats) -> Floats:
    """(...,) where along the axis (0 start, 1 end) points (..., 3) lie, clipped to it."""
    axis = part.end - part.start
    return np.clip((points - part.start) @ axis / (axis @ axis), 0.0, 1.0)


def distance(part: Part, points: Floats) -> Floats:
    """(...,) signed distance of points (..., 3) from the part's skin, metres, negative inside.

    The usual first-order bound for an ellipsoid, k0 (k0 − 1) / k1, taken on the ellipse of the
    nearest cross-section; exact for round sections, good near the skin for the others.
    """
    local = (points - part.start) @ part.frame.T
    along = local[..., 1]
    on_axis = np.clip(along, 0.0, part.length)
    place = on_axis / part.length * (DENSE - 1)
    left = np.minimum(place.astype(int), DENSE - 2)
    s = place - left

    def at(curve: Floats) -> Floats:
        return curve[left] + s * (curve[left + 1] - curve[left])

    width, depth = at(part.widths), at(part.depths)
    beyond = along - on_axis
    cap = np.where(beyond < 0, part.caps[0], part.caps[1])
    x, y, z = local[..., 0] / width, beyond / cap, (local[..., 2] - at(part.shift)) / depth
    k0 = np.sqrt(x * x + y * y + z * z)
    k1 = np.sqrt((x / width) ** 2 + (y / cap) ** 2 + (z / depth) ** 2)
    thin = np.minimum(width, depth)
    gap = (k0 - 1.0) * np.where(k1 > 1e-9, k0 / np.maximum(k1, 1e-9), thin)
    return (
        gap if part.floor is None else -smooth_union(-gap, points[..., 1] - part.floor, SOLE_EDGE)
    )


def bounds(part: Part) -> tuple[Floats, Floats]:
    """Lower and upper corners (3,) of a box that holds the part."""
    reach = max(
        float(np.max(part.widths)), float(np.max(part.depths + np.abs(part.shift))), *part.caps
    )
    ends = np.stack([part.start, part.end])
    return ends.min(axis=0) - reach, ends.max(axis=0) + reach


def smooth_union(a: Floats, b: Floats, radius: float) -> Floats:
    """Cubic polynomial minimum of two distances, rounding their crease over `radius`.

    Where the rounding ends the bend goes on without a jump, so that no ridge of shading shows.
    """
    mix = np.maximum(radius - np.abs(a - b), 0.0) / radius
    return np.minimum(a, b) - mix * mix * mix * radius / 6


def bone_weights(part: Part, places: Floats, names: tuple[str, ...]) -> Floats:
    """(..., B) weights of the bones `names` at `places` of the part's axis, summing to one."""
    weights = np.zeros((*np.shape(places), len(names)))
    stations = np.array([station for station, _ in part.bones])
    hats = np.eye(len(stations))
    for hat, (_, bone) in zip(hats, part.bones, strict=True):
        weights[..., names.index(bone)] += np.interp(places, stations, hat)
    return weights
