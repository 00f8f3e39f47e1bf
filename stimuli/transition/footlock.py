"""Standing feet held in a blend, eased in and out over the frames around.

A plant found in the sources is carried into the blend: it is A's while A weighs more, then B's.
While it lasts, the foot's slide is summed up and taken back by two-bone inverse kinematics; what
correction remains where a plant begins or ends fades over the neighbouring frames of swing.
"""

from itertools import pairwise

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion, Skeleton
from stimuli.transition.ik import bend_axis, reach_out
from stimuli.transition.plants import SIDES, Contacts, LegPose, contacts, leg_pose, legs_of, runs
from stimuli.transition.window import Window

EASE = 10  # frames over which a correction fades, fewer where the next plant is nearer
SWING = 6  # frames that a foot is given between two plants, which are cut short for it
FARTHEST = 0.30  # metres that a foot is moved at the most; beyond, it is held in part
_BEYOND = 45  # frames after the blend within which a plant must end


def lock_feet(motion: Motion, a: Motion, b: Motion, window: Window) -> Motion:
    """The blended motion with planted feet held; `a` and `b` are the sources as captured.

    Frames more than an easing away from plants that the blend touches are left as they are.
    """
    first = max(window.first - EASE, 0)
    rows = slice(first, min(window.last + _BEYOND + EASE, len(motion)))
    carried = _carried(contacts(a), contacts(b), window, rows)
    blend = (window.first - first, window.last - first)
    plants = [_touching(carried.stands[:, side], *blend) for side in range(len(SIDES))]
    ends = [last for of_side in plants for _, last in of_side]
    if not ends:
        return motion
    rows = slice(first, min(first + max(ends) + EASE + 1, rows.stop))
    pose = leg_pose(motion, rows)
    shift = _corrections(pose, carried.on_toe[: len(pose.toe)], plants, *blend)
    touched = np.flatnonzero(np.any(shift != 0, axis=(1, 2)))
    if not len(touched):
        return motion
    part = slice(int(touched[0]), int(touched[-1]) + 1)
    rotations = motion.rotations.copy()
    rotations[first + part.start : first + part.stop] = _moved(
        motion.skeleton, rotations[rows][part], _part(pose, part), shift[part]
    )
    return Motion(motion.skeleton, rotations, motion.root, motion.fps)


def _carried(a: Contacts, b: Contacts, window: Window, rows: slice) -> Contacts:
    """Contacts in some frames of the result: those of whoever weighs more."""
    frames = np.arange(rows.start, rows.stop)
    weight = np.clip(window.at_anchor + (frames - window.anchor) / (window.frames + 1), 0, 1)
    here = np.clip(frames, 0, len(a.stands) - 1)
    there = np.clip(frames + window.lag, 0, len(b.stands) - 1)
    rules = (weight > 0.5)[:, None]
    stands = np.where(rules, b.stands[there], a.stands[here])
    part = weight[:, None]
    return Contacts(stands, (1 - part) * a.on_toe[here] + part * b.on_toe[there])


def _touching(stands: np.ndarray, start: int, end: int) -> list[tuple[int, int]]:
    """Plants (first, last) of one foot that meet the blend, parted by a swing."""
    return [(p, q) for p, q in _parted(runs(stands)) if q >= start - 1 and p <= end + 1]


def _corrections(
    pose: LegPose, on_toe: Array, plants: list[list[tuple[int, int]]], start: int, end: int
) -> Array:
    """How far (N, 2, 3) on the floor the feet are to be moved in every frame."""
    slide = np.zeros_like(pose.ankle)
    part = 0.5 * (on_toe[1:] + on_toe[:-1])[..., None]
    slide[1:] = part * np.diff(pose.toe, axis=0) + (1 - part) * np.diff(pose.ankle, axis=0)
    slide[..., 1] = 0.0
    sides = [_held(slide[:, k], plants[k], start, end) for k in range(len(SIDES))]
    return np.stack(sides, axis=1)


def _held(slide: Array, plants: list[tuple[int, int]], start: int, end: int) -> Array:
    """Corrections (N, 3) of one foot that take back its slide (N, 3) while it stands."""
    shift = np.zeros_like(slide)
    for place, (begin, last) in enumerate(plants):
        begins = max(begin, start - 1)
        lasts = last if begin < start else min(last, end + 1)
        drift = np.cumsum(slide[begins : lasts + 1], axis=0) - slide[begins]
        correction = _anchored(drift, begin < start, last > end)
        correction *= min(
            1.0, FARTHEST / max(float(np.linalg.norm(correction, axis=1).max()), 1e-9)
        )
        shift[begins : lasts + 1] += correction
        before = begin - plants[place - 1][1] - 1 if place else EASE
        after = plants[place + 1][0] - last - 1 if place + 1 < len(plants) else EASE
        _fade(shift, correction[0], begins - 1, -1, min(before, EASE))
        if lasts == last:
            _fade(shift, correction[-1], lasts + 1, 1, min(after, EASE))
    return shift


def _parted(plants: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Plants (first, last) with facing ends cut back until a swing lies between; short ones go."""
    parted = [list(plant) for plant in plants]
    for one, other in pairwise(parted):
        lacking = max(SWING - (other[0] - one[1] - 1), 0)
        one[1] -= lacking // 2
        other[0] += lacking - lacking // 2
    return [(first, last) for first, last in parted if last > first]


def _anchored(drift: Array, from_before: bool, to_after: bool) -> Array:
    """The correction that takes back a drift, with nothing to correct where sources are pure."""
    if from_before:
        return -drift
    if to_after:
        return drift[-1] - drift
    return drift.mean(axis=0) - drift


def _fade(shift: Array, correction: Array, start: int, step: int, frames: int) -> None:
    """Add `correction`, fading by a smoothstep over `frames` from `start` on, forwards or back."""
    rows = start + step * np.arange(frames)
    s = np.arange(1, frames + 1) / (frames + 1)
    inside = (rows >= 0) & (rows < len(shift))
    fading = 1 - s * s * (3 - 2 * s)
    shift[rows[inside]] += fading[inside, None] * correction


def _part(pose: LegPose, part: slice) -> LegPose:
    return LegPose(*(getattr(pose, name)[part] for name in LegPose.__dataclass_fields__))


def _moved(skeleton: Skeleton, rotations: Array, pose: LegPose, shift: Array) -> Array:
    """Local rotations (N, J, 4) with the ankles moved by `shift`, the feet turned as they were."""
    legs = legs_of(skeleton)
    hips, knees, ankles = legs.joints
    hinge = bend_axis(pose.knee - pose.hip, pose.ankle - pose.knee, _usual_hinge(pose))
    turns = reach_out(pose.hip, pose.knee, pose.ankle, pose.ankle + shift, hinge)
    thigh, shank = (
        quat.multiply(t, q) for t, q in zip(turns, (pose.thigh, pose.shank), strict=True)
    )
    moved = rotations.copy()
    moved[:, hips] = quat.multiply(quat.inverse(pose.above), thigh) if legs.hip else thigh
    to_knee = _through(rotations, legs.chain[legs.hip + 1 : legs.knee], thigh)
    moved[:, knees] = quat.multiply(quat.inverse(to_knee), shank)
    to_ankle = _through(rotations, legs.chain[legs.knee + 1 : -1], shank)
    moved[:, ankles] = quat.multiply(quat.inverse(to_ankle), pose.foot)
    return moved


def _through(rotations: Array, links: np.ndarray, above: Array) -> Array:
    """Orientation (N, 2, 4) below the links that lie between two joints of a leg."""
    for joints in links:
        above = quat.multiply(above, rotations[:, joints])
    return above


def _usual_hinge(pose: LegPose) -> Array:
    """The axes (N, 2, 3) about which the knees bend, told by the frames where they bend most."""
    axis = quat.cross(pose.knee - pose.hip, pose.ankle - pose.knee)
    in_thigh = quat.rotate(quat.inverse(pose.thigh), axis).sum(axis=0)
    size = np.linalg.norm(in_thigh, axis=-1, keepdims=True)
    usual = np.where(size > 0, in_thigh / np.where(size > 0, size, 1.0), [1.0, 0.0, 0.0])
    return quat.rotate(pose.thigh, usual)
