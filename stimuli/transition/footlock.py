"""Standing feet held in a blend, eased in and out over the frames around.

A plant found in the sources is carried into the blend: it is A's while A weighs more, then B's.
Two-bone inverse kinematics moves the ankles by the corrections that `hold` finds; where a leg is
too straight to reach, the body sinks a little, which both legs take up.
"""

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion, Skeleton
from stimuli.transition.align import aligned, on_skeleton
from stimuli.transition.hold import APART, EASE, SETTLE, corrections, slid, touching, visible
from stimuli.transition.ik import bend_axis, reach_out
from stimuli.transition.plants import (
    LEVEL,
    Contacts,
    LegPose,
    contacts,
    floor_steps,
    leg_pose,
    legs_of,
    spans,
)
from stimuli.transition.reach import SINKING, reached, sinking
from stimuli.transition.weights import SIDES
from stimuli.transition.window import Window


def lock_feet(motion: Motion, a: Motion, b: Motion, window: Window) -> Motion:
    """The blended motion with planted feet held; `a` and `b` are the sources as they were played.

    Frames before the easing into the blend, and after that out of the last plant which the blend
    touches, are left as they are.
    """
    first = max(window.first - EASE, 0)
    carried = _carried(contacts(a), contacts(b), window, slice(first, len(motion)))
    blend = (window.first - first, window.last - first)
    return feet_held(motion, carried, first, blend, _two_places(motion.skeleton, a, b, window))


def feet_held(
    motion: Motion, carried: Contacts, first: int, blend: tuple[int, int], moved: Array
) -> Motion:
    """The motion with the feet held that stand, from its frame `first` on.

    `carried` (F − first rows) are the contacts that it should have, `blend` the first and last row
    in which a step may not be the captured one, `moved` (2,) how far either foot is to be held.
    """
    plants = [spans(carried.stands[:, side]) for side in range(len(SIDES))]
    lasts = [last for of_side in plants for _, last in touching(of_side, *blend)]
    if not lasts:
        return motion
    rows = slice(first, min(first + max(lasts) + SETTLE + SINKING + 1, len(motion)))
    pose = leg_pose(motion, rows)
    steps = floor_steps(pose, carried.on_toe[: len(pose.toe)])
    own = quat.rotate(pose.foot, carried.steps[: len(steps)]) * LEVEL
    slides = slid(steps, own) * moved[:, None]
    ends = rows.stop == len(motion)

    def corrected(side: int, within: Array, short: Array) -> Array:
        return corrections(slides[:, side], plants[side], *blend, ends, within, short)

    nowhere, never = np.zeros((len(steps), 3)), np.zeros(len(steps))
    shift = np.stack([corrected(side, nowhere, never) for side in range(len(SIDES))], axis=1)
    leg = pose.ankle - pose.hip
    whole = quat.norm(pose.knee - pose.hip) + quat.norm(pose.ankle - pose.knee)
    drop = sinking(leg, whole, shift, blend[0])
    within, short = reached(leg, whole, shift, drop)
    for side in np.flatnonzero(np.any(short > 0, axis=0)):
        shift[:, side] = corrected(side, within[:, side], short[:, side])
    touched = np.flatnonzero(np.any(shift != 0, axis=(1, 2)) | (drop > 0))
    if not len(touched):
        return motion
    part = slice(int(touched[0]), int(touched[-1]) + 1)
    frames = slice(first + part.start, first + part.stop)
    rotations, root = motion.rotations.copy(), motion.root.copy()
    rotations[frames] = feet_moved(
        motion.skeleton, rotations[frames], _part(pose, part), shift[part], drop[part]
    )
    root[frames, 1] -= drop[part]
    return Motion(motion.skeleton, rotations, root, motion.fps)


def _carried(a: Contacts, b: Contacts, window: Window, rows: slice) -> Contacts:
    """Contacts in some frames of the result: those of whoever weighs more."""
    frames = np.arange(rows.start, rows.stop)
    weight = np.clip(window.at_anchor + (frames - window.anchor) / (window.frames + 1), 0, 1)
    here = np.clip(frames, 0, len(a.stands) - 1)
    there = np.clip(frames + window.lag, 0, len(b.stands) - 1)
    rules = (weight > 0.5)[:, None]
    stands = np.where(rules, b.stands[there], a.stands[here])
    part = weight[:, None]
    steps = np.where(rules[..., None], b.steps[there], a.steps[here])
    return Contacts(stands, (1 - part) * a.on_toe[here] + part * b.on_toe[there], steps)


def _two_places(skeleton: Skeleton, a: Motion, b: Motion, window: Window) -> Array:
    """Whether either foot (2,) has two places to be held between: 0 where A and B are one, to 1.

    What slides where both have it in one place has come from the way of joining, not from two
    motions that differ: held, it would be taken farther from both.
    """
    first, last = max(window.first, -window.lag, 0), min(window.last, len(b) - 1 - window.lag)
    last = min(last, len(a) - 1)
    if last < first:
        return np.ones(len(SIDES))
    anchor = min(max(window.anchor, first), last)
    placed = aligned(a, on_skeleton(b, skeleton), anchor, anchor + window.lag)
    here = leg_pose(a, slice(first, last + 1))
    there = leg_pose(placed, slice(first + window.lag, last + window.lag + 1))
    gaps = [quat.norm(here.ankle - there.ankle), quat.norm(here.toe - there.toe)]
    return visible(np.max(gaps, axis=(0, 1)), APART)


def _part(pose: LegPose, part: slice) -> LegPose:
    return LegPose(*(getattr(pose, name)[part] for name in LegPose.__dataclass_fields__))


def feet_moved(
    skeleton: Skeleton, rotations: Array, pose: LegPose, shift: Array, drop: Array
) -> Array:
    """Local rotations (N, J, 4) that move ankles by `shift` (N, 2, 3), feet turned as they were.

    `pose` are the legs as they are. The body is to sink by `drop` (N,): its root is the caller's.
    """
    legs = legs_of(skeleton)
    hips, knees, ankles = legs.joints
    across = np.broadcast_to(pose.hip[:, :1] - pose.hip[:, 1:], pose.hip.shape)
    hinge, side = bend_axis(pose.knee - pose.hip, pose.ankle - pose.knee, pose.thigh, across)
    # a body that sinks takes its ankles along, which are brought back up
    target = pose.ankle + shift
    target[..., 1] += drop[:, None]
    turns = reach_out(pose.hip, pose.knee, pose.ankle, target, hinge, side)
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
