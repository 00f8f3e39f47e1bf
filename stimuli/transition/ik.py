"""Two bones and a target, in closed form: how thigh and shank turn for the ankle to arrive."""

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array

STRETCH = 0.998  # of a leg's whole length: as far as it is straightened; beyond, knees pop
_RIGHTED = 4.0  # times what its overstretching shortens a leg: changed by that, its knee turns over
_STRAIGHT = 0.01  # mean sine of the knees, about: below, the bend says less than the hips do


def reach_out(
    hip: Array, knee: Array, ankle: Array, target: Array, hinge: Array, side: Array
) -> tuple[Array, Array]:
    """World rotations (N, 4) of the thigh and of the shank that bring the ankle to its target.

    Positions (N, 3). The knee bends about `hinge` (N, 3), the axis about which it usually is bent;
    where it is overstretched (`side` (N,) is −1, else 1) it turns over as its leg is made shorter.
    A target out of reach is approached, limb lengths never change.

    Near straight an angle is a square root of a length: angles are counted from the one that is
    there, by differences, so that no rounding is magnified and no target means no turn.
    """
    thigh, shank = knee - hip, ankle - knee
    upper, lower = quat.norm(thigh), quat.norm(shank)
    before, after = ankle - hip, target - hip
    now = quat.norm(before)
    room = np.maximum(STRETCH * (upper + lower) - now, 0.0)
    change = np.vecdot(target - ankle, before + after) / (now + quat.norm(after))
    change = np.where(change > 0, _eased(change, room), change)
    change = np.maximum(change, np.abs(upper - lower) - now)
    angle = np.arctan2(quat.norm(quat.cross(thigh, shank)), np.vecdot(thigh, shank))
    to = _bent_to(angle, change * (2 * now + change) / (4 * upper * lower))
    overstretched = np.maximum(upper + lower - now, 1e-12)
    righted = np.minimum(np.abs(change) / (_RIGHTED * overstretched), 1.0)
    bend = _turn(hinge, np.where(side < 0, righted, 1.0) * (to - side * angle))
    bent = thigh + quat.rotate(bend, shank)
    aim = between(bent, after)
    return aim, quat.multiply(aim, bend)


def between(start: Array, end: Array) -> Array:
    """The smallest rotation (N, 4) that turns directions `start` (N, 3) into those of `end`."""
    dot = np.vecdot(start, end)
    size = quat.norm(start) * quat.norm(end)
    return quat.normalise(
        np.concatenate([(size + dot)[..., None], quat.cross(start, end)], axis=-1)
    )


def bend_axis(thigh: Array, shank: Array, orientation: Array, across: Array) -> tuple[Array, Array]:
    """Unit axes (N, ..., 3) about which shanks bend from thighs; near straight, the usual ones.

    And a side (N, ...): −1 where a knee is overstretched, whose axis would bend it back, else 1.

    Thighs and shanks (N, ..., 3) over N frames. The usual axis is one in the frame of the thigh,
    whose `orientation` (N, ..., 4) is given: the mean over the frames, most bent counting most, and
    `across` (N, ..., 3), from the right hip to the left, as far as they are all straight.
    """
    axis = quat.cross(thigh, shank)
    size = quat.norm(thigh) * quat.norm(shank)
    level = quat.norm(across)[..., None]
    hinted = axis + (_STRAIGHT * size)[..., None] * across / np.maximum(level, 1e-12)
    in_thigh = quat.rotate(quat.inverse(orientation), hinted).sum(axis=0)
    usual = in_thigh / np.maximum(quat.norm(in_thigh)[..., None], 1e-12)
    usual = quat.rotate(orientation, usual)
    sine = np.vecdot(axis, usual) / size
    trusted = np.clip((np.abs(sine) - 0.02) / 0.1, 0.0, 1.0)[..., None]
    side = np.where(sine < 0, -1.0, 1.0)
    own = (side / np.maximum(quat.norm(axis), 1e-12))[..., None] * axis
    mixed = trusted * own + (1 - trusted) * usual
    return mixed / np.maximum(quat.norm(mixed)[..., None], 1e-12), side


def _eased(change: Array, room: Array) -> Array:
    """A lengthening (N,) that never exceeds its room and hardly differs where that is ample."""
    limit = np.maximum(room, 1e-9)
    return np.asarray(change * limit / (np.abs(change) ** 4 + limit**4) ** 0.25)


def _bent_to(angle: Array, longer: Array) -> Array:
    """Angle (N,) from the thigh's direction to the shank's after a leg was lengthened.

    `longer` is by how much its square grew, over four times the product of thigh and shank: the
    cosine law as a difference of squared sines of half the angle.
    """
    square = np.square(np.sin(0.5 * angle)) - longer
    return np.asarray(2.0 * np.arcsin(np.sqrt(np.clip(square, 0.0, 1.0))))


def _turn(axis: Array, angle: Array) -> Array:
    return quat.exp(0.5 * angle[..., None] * axis)
