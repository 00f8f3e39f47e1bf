"""How long a blend should last by the speed of the joint that has farthest to go (Wang V.1.2)."""

from collections.abc import Callable

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.ties import first_least
from stimuli.transition.length import Length, no_room
from stimuli.transition.weights import MAJOR
from stimuli.transition.window import LONGEST, longest_fitting


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
    widest = first_least(-differences)
    joint, difference = joints[widest], float(differences[widest])
    speed = speed_of(_velocity_at(a, i, joint), _velocity_at(b, j, joint))
    longest = longest_fitting(a, b, i, j, specification)
    if longest < 1:
        raise no_room(i, j)
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
