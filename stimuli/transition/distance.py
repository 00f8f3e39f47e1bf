"""How far two poses are apart, for every pair of frames at once (Wang 2005, IV.2-IV.4).

Distances are in metres, half-angle radians and per frame. Poses are aligned on the floor before
they are compared, so that the root's term is the difference in height.
"""

import numpy as np
import numpy.typing as npt

from stimuli.errors import InputError
from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import forward, heading
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.transition.kernel import fused_angles
from stimuli.transition.weights import Weights, weighted_joints

MANY = 20_000_000  # cells times joints; below, loading the compiler costs more than it saves


def check_pair(a: Motion, b: Motion) -> None:
    """InputError unless both motions have the same hierarchy and rate."""
    if not a.skeleton.same_hierarchy(b.skeleton):
        raise InputError(
            f"two motions: expected one hierarchy, found {len(a.skeleton)} joints from "
            f"{a.skeleton.names[0]} and {len(b.skeleton)} from {b.skeleton.names[0]}, "
            "other names or order.\nJoin clips of one performer and exporter, or retarget one."
        )
    if a.fps != b.fps:
        raise InputError(f"two motions: expected one rate, found {a.fps:g} and {b.fps:g} a second.")


def joint_rotations(motion: Motion, joints: list[int]) -> Array:
    """Rotations (F, K, 4) by which joints are compared: local ones, the pelvis without heading."""
    rotations = motion.rotations[:, joints].copy()
    if 0 in joints or motion.skeleton.roles.get("pelvis") in joints:
        pelvis = motion.skeleton.roles.get("pelvis", 0)
        rotations[:, joints.index(pelvis)] = quat.multiply(
            quat.about("Y", -_headings(motion)), _world(motion, pelvis)
        )
    return rotations


def joint_velocities(motion: Motion, joints: list[int]) -> Array:
    """Angular velocities (F, K, 3) of the same joints, half-angle radians a frame, body frame."""
    rotations = motion.rotations[:, joints].copy()
    pelvis = motion.skeleton.roles.get("pelvis")
    if pelvis in joints:
        rotations[:, joints.index(pelvis)] = _world(motion, pelvis)
    return quat.angular_velocity(rotations)


def squared_angles(p: Array, q: Array, weights: Array) -> npt.NDArray[np.floating]:
    """Σ_k w_k θ²_k (FA, FB) between rotations (FA, K, 4) and (FB, K, 4); θ half the angle.

    Many cells go through the compiled kernel, in single precision, to 1e-5 of the exact sum: their
    last digits, and which of cells is the least that differ by those, hold on one machine alone.
    """
    if len(p) * len(q) * len(weights) > MANY:
        return fused_angles(p, q, weights)
    return exact_angles(p, q, weights)


def exact_angles(p: Array, q: Array, weights: Array) -> Array:
    """The same in double precision, in NumPy."""
    total = np.zeros((len(p), len(q)))
    for joint, weight in enumerate(weights):
        dots = np.abs(p[:, joint] @ q[:, joint].T)
        total += weight * np.square(np.arccos(np.minimum(dots, 1.0)))
    return total


def pose_distance(
    a: Motion, b: Motion, weights: str | Weights = "wang"
) -> npt.NDArray[np.floating]:
    """The rotations' part of the cost alone (FA, FB): Σ_k w_k θ²_k (V.2)."""
    check_pair(a, b)
    joints, scale = weighted_joints(a.skeleton, weights)
    return squared_angles(joint_rotations(a, joints), joint_rotations(b, joints), scale)


def cost_matrix(
    a: Motion, b: Motion, weights: str | Weights = "wang", velocity_weight: float = 1.0
) -> Array:
    """D(i, j) = d_p + ν d_v (FA, FB) of going over from frame i of `a` to frame j of `b`.

    ν is `velocity_weight`. Velocities are squared and per frame, so that they hardly count for ν up
    to 1 and outweigh the poses at 100.
    """
    check_pair(a, b)
    joints, scale = weighted_joints(a.skeleton, weights)
    distance = np.asarray(
        squared_angles(joint_rotations(a, joints), joint_rotations(b, joints), scale), dtype=float
    )
    distance += np.square(a.root[:, None, 1] - b.root[None, :, 1])
    if velocity_weight:
        first, second = (velocity_features(m, joints, scale) for m in (a, b))
        distance += velocity_weight * squared_euclidean(first, second)
    return distance


def root_cost(a: Motion, b: Motion, velocity_weight: float = 1.0) -> Array:
    """The root's part of the cost (FA, FB): difference of height, and of velocity on the floor."""
    check_pair(a, b)
    cost = np.square(a.root[:, None, 1] - b.root[None, :, 1])
    first, second = (velocity_features(m, [], np.empty(0)) for m in (a, b))
    return np.asarray(cost + velocity_weight * squared_euclidean(first, second))


def velocity_features(motion: Motion, joints: list[int], weights: Array) -> Array:
    """Vectors (F, 3 + 3K) whose squared differences are d_v: root velocity, then √w ω."""
    home = quat.about("Y", -_headings(motion))
    root = quat.rotate(home, quat.linear_velocity(motion.root))
    if not joints:
        return root
    angular = joint_velocities(motion, joints) * np.sqrt(weights)[:, None]
    return np.concatenate([root, angular.reshape(len(motion), -1)], axis=1)


def squared_euclidean(
    x: npt.NDArray[np.floating], y: npt.NDArray[np.floating]
) -> npt.NDArray[np.floating]:
    """‖x_i − y_j‖² (N, M) of rows."""
    squares = np.square(x).sum(axis=1)[:, None] + np.square(y).sum(axis=1)
    squares -= 2 * (x @ y.T)
    return np.maximum(squares, 0, out=squares)


def _headings(motion: Motion) -> Array:
    return heading(motion.skeleton, motion.rotations, motion.root)


def _world(motion: Motion, joint: int) -> Array:
    """Orientation (F, 4) of a joint in the world."""
    if joint == 0:
        return motion.rotations[:, 0]
    return forward(motion.skeleton, motion.rotations, motion.root)[1][:, joint]
