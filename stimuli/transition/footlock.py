"""Standing feet held in a blend, eased in and out over the frames around.

A plant found in the sources is carried into the blend: it is A's while A weighs more, then B's.
While it lasts, the foot's slide is summed up and taken back by two-bone inverse kinematics; what
correction remains where a plant begins or ends fades over the neighbouring frames of swing.
"""

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.transition.ik import bend_axis, reach_out
from stimuli.transition.plants import SIDES, Contacts, Leg, LegPose, contacts, leg_pose, runs
from stimuli.transition.window import Window

EASE = 10  # frames over which a correction fades, fewer where the next plant is nearer
_BEYOND = 45  # frames after the blend within which a plant must end


def lock_feet(motion: Motion, a: Motion, b: Motion, window: Window) -> Motion:
    """The blended motion with planted feet held; `a` and `b` are the sources as captured.

    Frames more than an easing away from plants that the blend touches are left as they are.
    """
    first = max(window.first - EASE, 0)
    after = min(window.last + _BEYOND + EASE, len(motion))
    carried = _carried(contacts(a), contacts(b), window, first, after)
    rotations = motion.rotations
    for side, name in enumerate(SIDES):
        leg = Leg.of(motion.skeleton, name)
        pose = leg_pose(motion, leg, slice(first, after))
        shift = _corrections(
            pose, carried.stands[:, side], carried.on_toe[:, side],
            window.first - first, window.last - first,
        )  # fmt: skip
        touched = np.flatnonzero(np.any(shift != 0, axis=1))
        if len(touched):
            rotations = rotations.copy() if rotations is motion.rotations else rotations
            part = slice(int(touched[0]), int(touched[-1]) + 1)
            rows = slice(first + part.start, first + part.stop)
            moved = _moved(motion, leg, _part(pose, part), shift[part], rows)
            for joint, local in moved.items():
                rotations[rows, joint] = local
    return Motion(motion.skeleton, rotations, motion.root, motion.fps)


def _carried(a: Contacts, b: Contacts, window: Window, first: int, after: int) -> Contacts:
    """Contacts of the frames `first` … `after` − 1 of the result: those of whoever weighs more."""
    frames = np.arange(first, after)
    weight = np.clip(window.at_anchor + (frames - window.anchor) / (window.frames + 1), 0, 1)
    here = np.clip(frames, 0, len(a.stands) - 1)
    there = np.clip(frames + window.lag, 0, len(b.stands) - 1)
    rules = (weight > 0.5)[:, None]
    stands = np.where(rules, b.stands[there], a.stands[here])
    part = weight[:, None]
    return Contacts(stands, (1 - part) * a.on_toe[here] + part * b.on_toe[there])


def _corrections(pose: LegPose, stands: np.ndarray, on_toe: Array, start: int, end: int) -> Array:
    """How far (N, 3) on the floor a foot is to be moved in every frame."""
    slide = np.zeros_like(pose.ankle)
    part = 0.5 * (on_toe[1:] + on_toe[:-1])[:, None]
    slide[1:] = part * np.diff(pose.toe, axis=0) + (1 - part) * np.diff(pose.ankle, axis=0)
    slide[:, 1] = 0.0
    plants = [(p, q) for p, q in runs(stands) if q >= start - 1 and p <= end + 1]
    shift = np.zeros_like(slide)
    held = []
    for begin, last in plants:
        begins = max(begin, start - 1)
        lasts = last if begin < start else min(last, end + 1)
        drift = np.cumsum(slide[begins : lasts + 1], axis=0) - slide[begins]
        held.append((begin, last, begins, lasts, _anchored(drift, begin < start, last > end)))
    for place, (begin, last, begins, lasts, correction) in enumerate(held):
        shift[begins : lasts + 1] += correction
        room = begin - (held[place - 1][1] if place else -EASE) - 1
        _fade(shift, correction[0], begins - 1, -1, min(room, EASE))
        following = held[place + 1][0] if place + 1 < len(held) else last + 1 + EASE
        if lasts == last:
            _fade(shift, correction[-1], lasts + 1, 1, min(following - last - 1, EASE))
    return shift


def _anchored(drift: Array, from_before: bool, to_after: bool) -> Array:
    """The correction that takes back a drift, with nothing to correct where sources are pure."""
    if from_before:
        return -drift
    if to_after:
        return drift[-1] - drift
    return drift.mean(axis=0) - drift


def _fade(shift: Array, correction: Array, start: int, step: int, frames: int) -> None:
    """Add `correction`, fading by a smoothstep over `frames` from `start` on, forwards or back."""
    for k in range(1, frames + 1):
        index = start + (k - 1) * step
        s = k / (frames + 1)
        if 0 <= index < len(shift):
            shift[index] += correction * (1 - s * s * (3 - 2 * s))


def _part(pose: LegPose, part: slice) -> LegPose:
    return LegPose(*(getattr(pose, name)[part] for name in LegPose.__dataclass_fields__))


def _moved(motion: Motion, leg: Leg, pose: LegPose, shift: Array, rows: slice) -> dict[int, Array]:
    """New local rotations of hip, knee and ankle that move the ankle by `shift`.

    The foot keeps its orientation in the world.
    """
    hinge = bend_axis(pose.knee - pose.hip, pose.ankle - pose.knee, _usual_hinge(pose))
    turn_thigh, turn_shank = reach_out(pose.hip, pose.knee, pose.ankle, pose.ankle + shift, hinge)
    thigh = quat.multiply(turn_thigh, pose.thigh)
    shank = quat.multiply(turn_shank, pose.shank)
    return {
        leg.hip: quat.multiply(quat.inverse(pose.above), thigh),
        leg.knee: _local(motion, leg.hip, leg.knee, thigh, shank, rows),
        leg.ankle: _local(motion, leg.knee, leg.ankle, shank, pose.foot, rows),
    }


def _local(
    motion: Motion, upper: int, lower: int, above: Array, wanted: Array, rows: slice
) -> Array:
    """Local rotation of `lower` that gives it the orientation wanted, with joints in between."""
    for link in motion.skeleton.chain(lower):
        if link in motion.skeleton.chain(upper) or link == lower:
            continue
        above = quat.multiply(above, motion.rotations[rows, link])
    return quat.multiply(quat.inverse(above), wanted)


def _usual_hinge(pose: LegPose) -> Array:
    """The axis (N, 3) about which this knee bends, known from the frames where it is bent most."""
    axis = quat.cross(pose.knee - pose.hip, pose.ankle - pose.knee)
    in_thigh = quat.rotate(quat.inverse(pose.thigh), axis).sum(axis=0)
    size = np.linalg.norm(in_thigh)
    usual = in_thigh / size if size > 0 else np.array([1.0, 0.0, 0.0])
    return quat.rotate(pose.thigh, np.broadcast_to(usual, axis.shape))
