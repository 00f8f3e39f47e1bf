"""Feet that roll no further on their shanks than an ankle lets them.

Some captured dances roll feet by up to 175°, which stick figures hide and a skin shows. Roll is
the twist of foot against shank about the foot's long axis, from the reference pose; what is beyond
the limit is taken out of the foot and its toes. The motion itself is not touched.
"""

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.render.landmarks import MIRRORED
from stimuli.render.rig import Rig


def limited_roll(
    rig: Rig, positions: Array, orientations: Array, limit: float
) -> tuple[Array, Array]:
    """Joints' positions (F, J, 3) and orientations (F, J, 4) with feet rolled `limit` at most.

    `limit` in radians. Joints below an ankle are turned with it.
    """
    placed, turned = positions.copy(), orientations.copy()
    rest, skeleton = rig.reference, rig.reference.skeleton
    for side, _ in MIRRORED:
        ankle = int(rig.joints[rig.names.index(f"{side}_ankle")])
        knee = int(rig.joints[rig.names.index(f"{side}_knee")])
        below = [j for j in range(len(skeleton)) if ankle in skeleton.chain(j)]
        roll, axis = foot_roll(rig, orientations, side)
        excess = np.clip(roll, -limit, limit) - roll
        if not np.any(excess):
            continue
        # about the foot's axis as the foot lies, in the world
        shank = quat.multiply(orientations[:, knee], quat.inverse(rest.orientations[knee]))
        foot = quat.multiply(orientations[:, ankle], quat.inverse(rest.orientations[ankle]))
        swing = quat.multiply(
            quat.multiply(quat.inverse(shank), foot), quat.inverse(_about(axis, roll))
        )
        wanted = quat.multiply(shank, quat.multiply(swing, _about(axis, roll + excess)))
        change = quat.multiply(wanted, quat.inverse(foot))
        for joint in below:
            arm = placed[:, joint] - positions[:, ankle]
            placed[:, joint] = positions[:, ankle] + quat.rotate(change, arm)
            turned[:, joint] = quat.multiply(change, orientations[:, joint])
    return placed, turned


def foot_roll(rig: Rig, orientations: Array, side: str) -> tuple[Array, Array]:
    """(F,) radians that a foot is rolled on its shank, and the foot's axis (3,) at rest."""
    rest = rig.reference
    knee, ankle = (int(rig.joints[rig.names.index(f"{side}_{part}")]) for part in ("knee", "ankle"))
    toe = int(rig.joints[rig.names.index(f"{side}_toe")])
    ahead = (rest.positions[toe] - rest.positions[ankle]) * [1.0, 0.0, 1.0]
    length = float(np.linalg.norm(ahead))
    axis = ahead / length if length > 1e-6 else np.array([0.0, 0.0, 1.0])
    shank, foot = (
        quat.multiply(orientations[:, joint], quat.inverse(rest.orientations[joint]))
        for joint in (knee, ankle)
    )
    between = quat.shorter(quat.multiply(quat.inverse(shank), foot))
    roll = np.unwrap(2.0 * np.arctan2(between[..., 1:] @ axis, between[..., 0]))
    return roll - 2 * np.pi * np.round(np.median(roll) / (2 * np.pi)), axis


def _about(axis: Array, angle: Array) -> Array:
    """(F, 4) turns by `angle` (F,) about an axis (3,)."""
    half = angle[:, None] / 2
    return np.concatenate([np.cos(half), np.sin(half) * axis], axis=-1)
