"""Bringing the *to* motion to where the *from* motion is: leg length, heading, floor position."""

import numpy as np

from stimuli.errors import InputError
from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import heading, placed
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion, Skeleton


def leg_length(skeleton: Skeleton) -> float:
    """Length of thigh and shank, the mean of both legs, metres; InputError if there is none."""
    links = skeleton.role("left_knee", "left_ankle", "right_knee", "right_ankle")
    length = float(np.linalg.norm(skeleton.offsets[links], axis=-1).sum() / 2)
    if length <= 0:
        raise InputError(
            f"skeleton of {skeleton.names[0]}: expected legs to scale a motion by, found none with "
            "any length.\nName other joints in an overrides file."
        )
    return length


def on_skeleton(motion: Motion, skeleton: Skeleton) -> Motion:
    """The motion on a skeleton of the same hierarchy, its root scaled by the ratio of the legs."""
    if skeleton is motion.skeleton:
        return motion
    same = np.array_equal(skeleton.offsets, motion.skeleton.offsets)
    ratio = 1.0 if same else leg_length(skeleton) / leg_length(motion.skeleton)
    return Motion(skeleton, motion.rotations, motion.root * ratio, motion.fps)


def aligned(a: Motion, b: Motion, i: int, j: int) -> Motion:
    """`b`, turned and moved on the floor so that its frame j has the heading and place of a[i]."""
    here, there = (_heading_at(a, i), _heading_at(b, j))
    yaw = here - there
    shift = a.root[i] - quat.rotate(quat.about("Y", yaw), b.root[j])
    return placed(b, yaw, _on_floor(shift))


def _heading_at(motion: Motion, frame: int) -> float:
    return float(heading(motion.skeleton, motion.rotations[frame], motion.root[frame]))


def _on_floor(shift: Array) -> Array:
    return np.asarray(shift * np.array([1.0, 0.0, 1.0]))
