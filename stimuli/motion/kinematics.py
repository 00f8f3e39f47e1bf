"""Forward kinematics, headings, and moving a motion about on the floor."""

import numpy as np

from stimuli.compiled import worth_loading
from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion, Skeleton


def forward(skeleton: Skeleton, rotations: Array, root: Array) -> tuple[Array, Array]:
    """Joint positions (..., J, 3) in metres and orientations (..., J, 4) in the world.

    `rotations` (..., J, 4) are local, `root` (..., 3) is where the root joint stands.
    """
    if worth_loading(rotations.size):
        return _followed(skeleton, rotations, root)
    return _by_levels(skeleton, rotations, root)


def _followed(skeleton: Skeleton, rotations: Array, root: Array) -> tuple[Array, Array]:
    """The same by the compiled loop."""
    from stimuli.motion.kinematics_loop import follow

    frames, joints = rotations.shape[:-2], len(skeleton)
    positions, orientations = np.empty((*frames, joints, 3)), np.empty((*frames, joints, 4))
    root = np.broadcast_to(root, (*frames, 3))
    follow(
        _whole(rotations, float).reshape(-1, joints, 4),
        _whole(root, float).reshape(-1, 3),
        _whole(skeleton.offsets, float),
        _whole(skeleton.parents, np.int64),
        positions.reshape(-1, joints, 3),
        orientations.reshape(-1, joints, 4),
    )
    return positions, orientations


def _whole(values: np.ndarray, kind: type) -> np.ndarray:
    """The array as the loop was compiled for it: of one piece, and no view that is read-only."""
    return np.require(values, kind, ["C", "W"])


def _by_levels(skeleton: Skeleton, rotations: Array, root: Array) -> tuple[Array, Array]:
    """The same by NumPy, the joints of one depth at a time."""
    orientations = np.empty(rotations.shape)
    orientations[..., 0, :] = rotations[..., 0, :]
    for joints, parents in skeleton.levels:
        above = orientations[..., parents, :]
        orientations[..., joints, :] = quat.multiply(above, rotations[..., joints, :])
    bones = quat.rotate(orientations[..., skeleton.parents, :], skeleton.offsets)
    positions = np.empty(bones.shape)
    positions[..., 0, :] = root
    for joints, parents in skeleton.levels:
        positions[..., joints, :] = positions[..., parents, :] + bones[..., joints, :]
    return positions, orientations


def end_positions(skeleton: Skeleton, positions: Array, orientations: Array) -> Array:
    """Positions (..., E, 3) of the end sites, from those of the joints."""
    parents = skeleton.end_parents
    return positions[..., parents, :] + quat.rotate(
        orientations[..., parents, :], skeleton.end_offsets
    )


def joint_positions(skeleton: Skeleton, rotations: Array, root: Array, joint: int) -> Array:
    """Position (..., 3) of one joint, by its own chain alone."""
    position, orientation = root, rotations[..., 0, :]
    for link in skeleton.chain(joint)[1:]:
        position = position + quat.rotate(orientation, skeleton.offsets[link])
        orientation = quat.multiply(orientation, rotations[..., link, :])
    return position


def heading(skeleton: Skeleton, rotations: Array, root: Array) -> Array:
    """Yaw (...,) of the facing direction, radians: (sin yaw, 0, cos yaw) on the floor.

    The facing direction is left × up with left = left hip − right hip projected on the floor.
    InputError for a skeleton without hips.
    """
    left, right = skeleton.role("left_hip", "right_hip")
    across = joint_positions(skeleton, rotations, root, left) - joint_positions(
        skeleton, rotations, root, right
    )
    return np.asarray(np.arctan2(-across[..., 2], across[..., 0]))


def headings(motion: Motion) -> Array:
    """Heading (F,) of every frame of a motion, radians."""
    return heading(motion.skeleton, motion.rotations, motion.root)


def placed(motion: Motion, yaw: float, shift: Array) -> Motion:
    """The motion turned by `yaw` about the vertical through the origin, then moved by `shift`."""
    turn = quat.about("Y", yaw)
    rotations = motion.rotations.copy()
    rotations[:, 0] = quat.multiply(turn, rotations[:, 0])
    root = quat.rotate(turn, motion.root) + shift
    return Motion(motion.skeleton, rotations, root, motion.fps)
