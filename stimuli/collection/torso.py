"""Poses as the body itself sees them: in the torso frame of Arikan and Forsyth (2002, appendix A).

Its origin is the root's place on the floor, its heading the body's own. What is told in it does not
depend on where and in which heading a clip lies.
"""

from typing import NamedTuple

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import forward, headings
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion


class FloorFrames(NamedTuple):
    """Where a body is over the floor, a row a frame: x and z in metres, heading in radians."""

    place: Array  # (F, 2)
    yaw: Array  # (F,)


def floor_frames(motion: Motion) -> FloorFrames:
    """The torso frame of every frame of a motion, as seen from above."""
    return FloorFrames(motion.root[:, [0, 2]], headings(motion))


def torso_features(motion: Motion, joints: list[int]) -> tuple[Array, Array]:
    """D and its rate, each (F, K + 2, 3): places of K joints, the torso's velocity, its turning.

    Metres and radians; velocity, the rotation vector of the step to the next frame, and rates of
    change are per frame, those of the last frames being the last that there are (eq. 2).
    """
    positions, orientations = forward(motion.skeleton, motion.rotations, motion.root)
    home = quat.about("Y", -headings(motion))
    origin = motion.root * np.array([1.0, 0.0, 1.0])
    places = quat.rotate(home[:, None], positions[:, joints] - origin[:, None])
    step = quat.rotate(home[:-1], np.diff(motion.root, axis=0))
    turn = quat.multiply(orientations[1:, 0], quat.inverse(orientations[:-1, 0]))
    turning = quat.rotate(home[:-1], 2.0 * quat.log(quat.shorter(turn)))
    moving = np.stack([step, turning], axis=1)
    features = np.concatenate([places, _with_ends(moving, 1)], axis=1)
    rates = np.concatenate(
        [_with_ends(np.diff(places, axis=0), 1), _with_ends(np.diff(moving, axis=0), 2)], axis=1
    )
    return features, rates


def _with_ends(values: Array, missing: int) -> Array:
    """Values with the last one repeated for frames that have none."""
    return np.concatenate([values, np.repeat(values[-1:], missing, axis=0)])
