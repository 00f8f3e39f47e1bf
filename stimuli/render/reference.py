"""The pose a body is built in: upright, arms and legs a little apart, facing +Z.

A skeleton's zero pose need not be a stance (exporters put anything there), so the body is built
on a pose known to be one: the zero pose where it is sane, else the frame of the motion that
needs the least turning, brought to an A-pose by the smallest turn of each bone, parents first.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import forward, heading
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion, Skeleton
from stimuli.render.posture import head_pitch, usual_posture
from stimuli.ties import first_least

ARM, _THIGH, _SHANK, TOES = np.radians([50.0, 7.0, 4.0, 8.0])
STRAIGHT = np.radians(25.0)
LOOKED_AT = 200
AS_NEAR = 1e-9  # radians²: frames as near to the A-pose, as the two ends of a loop are


@dataclass(frozen=True, eq=False)
class Reference:
    """Joints of a skeleton in the A-pose; the hips' middle stands over the origin."""

    skeleton: Skeleton
    positions: Array  # (J, 3) metres
    orientations: Array  # (J, 4)
    frame: int  # the frame the pose was made from, -1 for the zero pose
    neck_tilt: float  # radians, forwards from the trunk
    head_pitch: float  # radians by which the head was lowered, for the face to be level usually


def reference_pose(motion: Motion) -> Reference:
    """The A-pose of a motion's skeleton (its roles decide which bones are turned)."""
    skeleton = motion.skeleton
    frame = -1 if _stands(skeleton) else _straightest(motion)
    local = _zero(skeleton) if frame < 0 else motion.rotations[frame]
    turned = _facing_front(skeleton, local)
    head = skeleton.roles.get("head", 0)
    usual = usual_posture(motion, head)
    for role, rotation in usual.toes.items():
        turned[skeleton.roles[role]] = rotation
    positions, orientations = forward(skeleton, turned, np.zeros(3))
    posed = _swung(skeleton, positions, orientations, usual.neck_tilt)
    positions, orientations = forward(skeleton, posed, np.zeros(3))
    pitch = head_pitch(usual, orientations[head]) if head else 0.0
    if head:
        orientations[head] = quat.multiply(quat.about("X", -pitch), orientations[head])
    left, right = skeleton.role("left_hip", "right_hip")
    middle = (positions[left] + positions[right]) / 2
    return Reference(
        skeleton, positions - middle * [1, 0, 1], orientations, frame, usual.neck_tilt, pitch
    )


def targets(neck_tilt: float = 0.0) -> Mapping[str, tuple[str, Array]]:
    """Role → (role at the bone's other end, unit direction of the bone in the A-pose)."""
    up = np.array([0.0, 1.0, 0.0])
    table = {
        "spine": ("chest", up),
        "chest": ("neck", up),
        "neck": ("head", np.array([0.0, np.cos(neck_tilt), np.sin(neck_tilt)])),
    }
    for side, sign in (("left", 1.0), ("right", -1.0)):
        arm = np.array([sign * np.cos(ARM), -np.sin(ARM), 0.0])
        table |= {
            f"{side}_shoulder": (f"{side}_elbow", arm),
            f"{side}_elbow": (f"{side}_wrist", arm),
            f"{side}_hip": (f"{side}_knee", _down(sign, _THIGH)),
            f"{side}_knee": (f"{side}_ankle", _down(sign, _SHANK)),
        }
    return table


def _down(sign: float, angle: float) -> Array:
    return np.array([sign * np.sin(angle), -np.cos(angle), 0.0])


def _zero(skeleton: Skeleton) -> Array:
    return np.tile(quat.IDENTITY, (len(skeleton), 1))


def _facing_front(skeleton: Skeleton, rotations: Array) -> Array:
    """Local rotations (..., J, 4) with the root turned so that the heading is 0."""
    yaw = heading(skeleton, rotations, np.zeros(3))
    turned = rotations.copy()
    turned[..., 0, :] = quat.multiply(quat.about("Y", -yaw), rotations[..., 0, :])
    return turned


def _stands(skeleton: Skeleton) -> bool:
    """Whether the zero pose is a person: trunk upright, hips and shoulders parallel, feet below."""
    if bool({"left_shoulder", "right_shoulder"} - set(skeleton.roles)):
        return False
    rotations = _facing_front(skeleton, _zero(skeleton))
    at, _ = forward(skeleton, rotations, np.zeros(3))
    hips = [at[joint] for joint in skeleton.role("left_hip", "right_hip")]
    shoulders = [at[joint] for joint in skeleton.role("left_shoulder", "right_shoulder")]
    ankles = [at[joint] for joint in skeleton.role("left_ankle", "right_ankle")]
    trunk = np.mean(shoulders, axis=0) - np.mean(hips, axis=0)
    leg = np.mean(ankles, axis=0) - np.mean(hips, axis=0)
    limit = np.cos(STRAIGHT)
    return bool(
        np.linalg.norm(trunk) > 0.4 * np.linalg.norm(leg)
        and trunk[1] > limit * np.linalg.norm(trunk)
        and -leg[1] > limit * np.linalg.norm(leg)
        and _unit(hips[0] - hips[1]) @ _unit(shoulders[0] - shoulders[1]) > limit
    )


def _straightest(motion: Motion) -> int:
    """The frame whose bones are nearest the A-pose, of at most `LOOKED_AT` evenly spread ones."""
    frames = np.unique(np.linspace(0, len(motion) - 1, LOOKED_AT).astype(int))
    rotations = _facing_front(motion.skeleton, motion.rotations[frames])
    positions, _ = forward(motion.skeleton, rotations, np.zeros((len(frames), 3)))
    roles = motion.skeleton.roles
    score = np.zeros(len(frames))
    for role, (other, wanted) in targets().items():
        if role in roles and other in roles:
            bone = _unit(positions[:, roles[other]] - positions[:, roles[role]])
            score += np.arccos(np.clip(bone @ wanted, -1, 1)) ** 2
    return int(frames[first_least(score, AS_NEAR)])


def _swung(skeleton: Skeleton, positions: Array, orientations: Array, neck_tilt: float) -> Array:
    """(J, 4) local rotations in which each bone of `targets` points where it should."""
    bones = {
        skeleton.roles[role]: (skeleton.roles[other], wanted)
        for role, (other, wanted) in targets(neck_tilt).items()
        if role in skeleton.roles and other in skeleton.roles
    }
    for side, sign in (("left", 1.0), ("right", -1.0)):
        if f"{side}_toe" in skeleton.roles and f"{side}_ankle" in skeleton.roles:
            ankle, toe = skeleton.role(f"{side}_ankle", f"{side}_toe")
            bones[ankle] = (toe, foot_direction(skeleton, ankle, toe, sign))
    turned = np.empty_like(orientations)
    for joint, parent in enumerate(skeleton.parents):
        carried = (
            orientations[joint]
            if parent < 0
            else quat.multiply(turned[parent], _local(orientations, joint, int(parent)))
        )
        if joint in bones:
            other, wanted = bones[joint]
            bone = quat.rotate(
                quat.multiply(carried, quat.inverse(orientations[joint])),
                positions[other] - positions[joint],
            )
            carried = quat.multiply(swing(bone, wanted), carried)
        elif parent < 0:
            carried = quat.multiply(_upright(skeleton, positions), carried)
        turned[joint] = carried
    local = turned.copy()
    for joint, parent in enumerate(skeleton.parents):
        if parent >= 0:
            local[joint] = quat.multiply(quat.inverse(turned[parent]), turned[joint])
    return local


def foot_direction(skeleton: Skeleton, ankle: int, toe: int, sign: float) -> Array:
    """(3,) the direction from ankle to toe joint when the sole is flat: forward and down."""
    length = float(np.linalg.norm(skeleton.offsets[toe]))
    drop = min(0.45 * length, 0.055)
    level = np.sqrt(length**2 - drop**2)
    return np.array([sign * np.sin(TOES) * level, -drop, np.cos(TOES) * level]) / length


def _upright(skeleton: Skeleton, positions: Array) -> Array:
    """(4,) the turn that brings the line from hips to neck (or shoulders) upright."""
    left, right = skeleton.role("left_hip", "right_hip")
    top = [skeleton.roles[r] for r in ("left_shoulder", "right_shoulder") if r in skeleton.roles]
    if not top:
        return quat.IDENTITY
    trunk = positions[top].mean(axis=0) - (positions[left] + positions[right]) / 2
    return swing(trunk, np.array([0.0, 1.0, 0.0]))


def swing(source: Array, target: Array) -> Array:
    """(4,) the smallest rotation that takes the direction of `source` to that of `target`."""
    a, b = _unit(source), _unit(target)
    q = np.concatenate([[1.0 + a @ b], np.cross(a, b)])
    if q[0] < 1e-9:  # opposite directions: half a turn about any axis across them
        across = np.cross(a, [1.0, 0.0, 0.0] if abs(a[0]) < 0.9 else [0.0, 1.0, 0.0])
        q = np.concatenate([[0.0], across])
    return quat.normalise(q)


def _local(orientations: Array, joint: int, parent: int) -> Array:
    return quat.multiply(quat.inverse(orientations[parent]), orientations[joint])


def _unit(v: Array) -> Array:
    return np.asarray(v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-12))
