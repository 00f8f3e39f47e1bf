"""How a body usually holds its neck, head and toes in a motion.

Many skeletons leave these arbitrary in their zero pose, so that a head built upright there looks
up or down for the whole clip, a neck is bent back and toes stand off. The body is built to look
right in the motion's usual posture; the motion itself is not touched.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import forward, headings
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion

WITHIN_UPRIGHT = np.radians(35.0)
MOST_TILT, MOST_PITCH = np.radians([30.0, 20.0])


@dataclass(frozen=True, eq=False)
class Posture:
    """Medians over the upright frames of a motion, bounded."""

    neck_tilt: float  # radians, of the line from neck to head, forwards from the trunk's
    heads: Array  # (F, 4) orientations of the head there
    toes: Mapping[str, Array]  # role of a toe joint → (4,) its usual local rotation


def usual_posture(motion: Motion, head: int) -> Posture:
    """Look at the frames in which the trunk is upright, or at all where it never is."""
    roles = motion.skeleton.roles
    positions, orientations = forward(motion.skeleton, motion.rotations, motion.root)
    yaw = headings(motion)
    ahead = np.stack([np.sin(yaw), np.zeros_like(yaw), np.cos(yaw)], axis=-1)
    hips, shoulders = (
        positions[:, motion.skeleton.role(f"left_{part}", f"right_{part}")].mean(axis=1)
        for part in ("hip", "shoulder")
    )
    trunk = shoulders - hips
    chosen = trunk[:, 1] > np.cos(WITHIN_UPRIGHT) * np.linalg.norm(trunk, axis=1)
    chosen = chosen if chosen.any() else np.ones_like(chosen)
    tilt = 0.0
    if "neck" in roles and "head" in roles and roles["neck"] != roles["head"]:
        neck = positions[:, roles["head"]] - positions[:, roles["neck"]]
        tilt = float(np.median((_lean(neck, ahead) - _lean(trunk, ahead))[chosen]))
    toes = {
        role: _median_rotation(motion.rotations[:, roles[role]])
        for role in ("left_toe", "right_toe")
        if role in roles
    }
    return Posture(
        float(np.clip(tilt, -MOST_TILT, MOST_TILT)),
        orientations[chosen, head],
        toes,
    )


def head_pitch(posture: Posture, reference: Array) -> float:
    """Radians the face usually looks up, for a head that looks level when turned as `reference`."""
    turned = quat.multiply(posture.heads, quat.inverse(reference))
    face = quat.rotate(turned, np.array([0.0, 0.0, 1.0]))
    return float(np.clip(np.median(np.arcsin(np.clip(face[:, 1], -1, 1))), -MOST_PITCH, MOST_PITCH))


def _lean(bone: Array, ahead: Array) -> Array:
    """(F,) radians a bone leans forwards from the vertical."""
    return np.arctan2(np.einsum("fi,fi->f", bone, ahead), bone[:, 1])


def _median_rotation(rotations: Array) -> Array:
    """(4,) the rotation whose half rotation vector has the medians of those of `rotations`."""
    return quat.exp(np.median(quat.log(quat.shorter(rotations)), axis=0))
