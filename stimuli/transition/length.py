"""How long a blend should last (Wang 2005, chapter V): one function a method, in a table."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np

from stimuli.errors import InputError
from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.transition.distance import check_pair, pose_distance
from stimuli.transition.weights import MAJOR, Weights
from stimuli.transition.window import LONGEST, check_frames, longest_fitting, specified

FIXED = 10
LengthFunction = Callable[[Motion, Motion, int, int, str], "Length"]


@dataclass(frozen=True)
class Length:
    """A blend length in frames, and how the method came to it."""

    frames: int
    report: Mapping[str, Any] = field(default_factory=dict)


def length_fixed(a: Motion, b: Motion, i: int, j: int, specification: str) -> Length:
    """Ten frames, a third of a second."""
    return Length(FIXED)


def geodesic_costs(
    a: Motion,
    b: Motion,
    i: int,
    j: int,
    specification: str,
    weights: str | Weights = "wang",
) -> Array:
    """The mean distance over the frames mixed for b = 1 … 60 (V.1, V.2); NaN where none fits."""
    reach = LONGEST
    from_a, from_b = max(i - reach, 0), max(j - reach, 0)
    distance = pose_distance(a[from_a : i + reach], b[from_b : j + reach], weights)
    costs = np.full(LONGEST, np.nan)
    make = specified(specification)
    for frames in range(1, LONGEST + 1):
        window = make(i, j, frames)
        if window.fits(a, b):
            rows = np.arange(window.first, window.last + 1)
            costs[frames - 1] = distance[rows - from_a, rows + window.lag - from_b].mean()
    return costs


def length_geodesic(a: Motion, b: Motion, i: int, j: int, specification: str) -> Length:
    """The length whose mixed frames differ least on average (V.1), the smaller one on a tie."""
    costs = geodesic_costs(a, b, i, j, specification)
    if np.all(np.isnan(costs)):
        raise _no_room(i, j)
    best = int(np.nanargmin(costs))
    return Length(best + 1, {"costs": costs, "cost": float(costs[best])})


def length_velocity(a: Motion, b: Motion, i: int, j: int, specification: str) -> Length:
    """The largest joint difference over the norm of that joint's mean velocity (V.3, V.4)."""
    return _by_velocity(
        a, b, i, j, specification, lambda v, w: float(np.linalg.norm(0.5 * (v + w)))
    )


def length_velocity_speed(a: Motion, b: Motion, i: int, j: int, specification: str) -> Length:
    """As `velocity`, with the mean of the two speeds: steadier where they turn opposite ways."""
    return _by_velocity(
        a, b, i, j, specification, lambda v, w: float(np.linalg.norm(v) + np.linalg.norm(w)) / 2
    )


def _by_velocity(
    a: Motion,
    b: Motion,
    i: int,
    j: int,
    specification: str,
    speed_of: Callable[[Array, Array], float],
) -> Length:
    joints = a.skeleton.role(*MAJOR)
    differences = quat.geodesic(a.rotations[i, joints], b.rotations[j, joints])
    widest = int(np.argmax(differences))
    joint, difference = joints[widest], float(differences[widest])
    speed = speed_of(_velocity_at(a, i, joint), _velocity_at(b, j, joint))
    longest = longest_fitting(a, b, i, j, specification)
    if longest < 1:
        raise _no_room(i, j)
    wanted = difference / speed if speed > 0 else np.inf if difference > 0 else 0.0
    frames = int(np.floor(min(wanted, LONGEST) + 0.5))
    clamped = min(max(frames, 1), longest)
    report = {
        "joint": MAJOR[widest],
        "difference": difference,
        "speed": speed,
        "wanted": wanted,
        "clamped": bool(clamped != np.floor(wanted + 0.5)),
    }
    return Length(clamped, report)


def _velocity_at(motion: Motion, frame: int, joint: int) -> Array:
    """Angular velocity (3,) of a joint at a frame."""
    first = max(frame - 1, 0)
    around = quat.angular_velocity(motion.rotations[first : frame + 2, joint])
    return np.asarray(around[frame - first])


def _no_room(i: int, j: int) -> InputError:
    return InputError(
        f"transition {i} → {j}: expected room for a blend, found none: "
        "even the shortest leaves a motion.\nChoose frames farther from the ends."
    )


LENGTHS: Mapping[str, LengthFunction] = MappingProxyType(
    {
        "fixed": length_fixed,
        "geodesic": length_geodesic,
        "velocity": length_velocity,
        "velocity-speed": length_velocity_speed,
    }
)


def blend_length(
    a: Motion, b: Motion, i: int, j: int, method: str, specification: str = "start-end"
) -> Length:
    """How long a blend from frame i of `a` to frame j of `b` should last, by a method's own rule.

    InputError for motions of different hierarchies, frames that do not exist, unknown names.
    """
    check_pair(a, b)
    check_frames(a, b, i, j)
    specified(specification)
    if method not in LENGTHS:
        raise InputError(f"length: expected one of {', '.join(LENGTHS)}, found {method!r}.")
    return LENGTHS[method](a, b, i, j, specification)
