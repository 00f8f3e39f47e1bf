"""Two bones and a target, in closed form: how thigh and shank turn for the ankle to arrive."""

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array

STRETCH = 0.998  # of a leg's whole length: as far as it is straightened; beyond, knees pop
_RIGHTED = (
    0.02  # metres by which a leg is lengthened or shortened for an overstretched knee to bend
)


def reach_out(
    hip: Array, knee: Array, ankle: Array, target: Array, hinge: Array, side: Array
) -> tuple[Array, Array]:
    """World rotations (N, 4) of the thigh and of the shank that bring the ankle to its target.

    Positions (N, 3). The knee bends about `hinge` (N, 3), the axis about which it usually is bent;
    where it is overstretched (`side` (N,) is −1, else 1) it turns over as its leg is made shorter.
    A target out of reach is approached, limb lengths never change.
    """
    thigh, shank = knee - hip, ankle - knee
    upper, lower = quat.norm(thigh), quat.norm(shank)
    before = ankle - hip
    now = quat.norm(before)
    room = np.maximum(STRETCH * (upper + lower) - now, 0.0)
    change = quat.norm(target - hip) - now
    wanted = np.maximum(now + np.where(change > 0, _eased(change, room), change), upper - lower)
    wanted = np.maximum(wanted, lower - upper)
    angle, to = side * _knee_angle(upper, lower, now), _knee_angle(upper, lower, wanted)
    righted = np.minimum(np.abs(wanted - now) / _RIGHTED, 1.0)
    bend = _turn(hinge, np.where(side < 0, righted, 1.0) * (to - angle))
    bent = thigh + quat.rotate(bend, shank)
    aim = between(bent, target - hip)
    return aim, quat.multiply(aim, bend)


def between(start: Array, end: Array) -> Array:
    """The smallest rotation (N, 4) that turns directions `start` (N, 3) into those of `end`."""
    dot = np.vecdot(start, end)
    size = quat.norm(start) * quat.norm(end)
    return quat.normalise(
        np.concatenate([(size + dot)[..., None], quat.cross(start, end)], axis=-1)
    )


def bend_axis(thigh: Array, shank: Array, orientation: Array) -> tuple[Array, Array]:
    """Unit axes (N, ..., 3) about which shanks bend from thighs; near straight, the usual ones.

    And a side (N, ...): −1 where a knee is overstretched, whose axis would bend it back, else 1.

    Thighs and shanks (N, ..., 3) over N frames. The usual axis is one in the frame of the thigh,
    whose `orientation` (N, ..., 4) is given: the mean over the frames, most bent counting most.
    """
    axis = quat.cross(thigh, shank)
    in_thigh = quat.rotate(quat.inverse(orientation), axis).sum(axis=0)
    size = quat.norm(in_thigh)[..., None]
    usual = np.where(size > 0, in_thigh / np.where(size > 0, size, 1.0), [1.0, 0.0, 0.0])
    usual = quat.rotate(orientation, usual)
    sine = np.vecdot(axis, usual) / (quat.norm(thigh) * quat.norm(shank))
    trusted = np.clip((np.abs(sine) - 0.02) / 0.1, 0.0, 1.0)[..., None]
    side = np.where(sine < 0, -1.0, 1.0)
    own = (side / np.maximum(quat.norm(axis), 1e-12))[..., None] * axis
    mixed = trusted * own + (1 - trusted) * usual
    return mixed / np.maximum(quat.norm(mixed)[..., None], 1e-12), side


def _eased(change: Array, room: Array) -> Array:
    """A lengthening (N,) that never exceeds its room and hardly differs where that is ample."""
    limit = np.maximum(room, 1e-9)
    return np.asarray(change * limit / (np.abs(change) ** 4 + limit**4) ** 0.25)


def _knee_angle(upper: Array, lower: Array, distance: Array) -> Array:
    """Angle (N,) from the thigh's direction to the shank's when hip and ankle are so far apart."""
    cosine = (distance**2 - upper**2 - lower**2) / (2 * upper * lower)
    return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)))


def _turn(axis: Array, angle: Array) -> Array:
    return quat.exp(0.5 * angle[..., None] * axis)
