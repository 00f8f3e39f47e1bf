"""Two bones and a target, in closed form: how thigh and shank turn for the ankle to arrive."""

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array

STRETCH = 0.998  # of a leg's whole length: as far as it is straightened; beyond, knees pop
EASY = 0.992  # of it: as far as a leg reaches without being straightened
DEEPEST = 0.03  # metres that a body sinks at the most for its legs to reach
_REACH = 5  # frames to either side over which the body sinks, and as many for its smoothing


def reach_out(
    hip: Array, knee: Array, ankle: Array, target: Array, hinge: Array
) -> tuple[Array, Array]:
    """World rotations (N, 4) of the thigh and of the shank that bring the ankle to its target.

    Positions (N, 3). The knee keeps its side: it bends about `hinge` (N, 3), the axis about which
    it is bent already. A target out of reach is approached, limb lengths never change.
    """
    thigh, shank = knee - hip, ankle - knee
    upper, lower = _size(thigh), _size(shank)
    before = ankle - hip
    now = _size(before)
    room = np.maximum(STRETCH * (upper + lower) - now, 0.0)
    change = _size(target - hip) - now
    wanted = np.maximum(now + np.where(change > 0, _eased(change, room), change), upper - lower)
    wanted = np.maximum(wanted, lower - upper)
    bend = _turn(hinge, _knee_angle(upper, lower, wanted) - _knee_angle(upper, lower, now))
    bent = thigh + quat.rotate(bend, shank)
    aim = between(bent, target - hip)
    return aim, quat.multiply(aim, bend)


def sinking(hip: Array, knee: Array, ankle: Array, shift: Array) -> Array:
    """How far (N,) metres a body is to sink for its ankles to be moved by `shift`, smoothly.

    Positions and shift (N, 2, 3) of both legs. Nothing before and after ten frames around those in
    which a moved ankle lies farther from its hip than the leg easily reaches.
    """
    whole = _size(knee - hip) + _size(ankle - knee)
    now = _size(ankle - hip)
    away = ankle + shift - hip
    across = np.square(away[..., 0]) + np.square(away[..., 2])
    allowed = np.square(np.maximum(now, EASY * whole))
    above = np.sqrt(np.maximum(allowed - across, 0.0))
    needed = np.where(np.any(shift != 0, axis=-1), -away[..., 1] - above, 0.0).max(axis=1)
    needed = np.clip(needed, 0.0, DEEPEST)
    if not needed.any():
        return needed
    wide = np.pad(needed, 2 * _REACH)
    largest = np.lib.stride_tricks.sliding_window_view(wide, 2 * _REACH + 1).max(axis=1)
    kernel = np.hanning(2 * _REACH + 3)[1:-1]
    return np.convolve(largest, kernel / kernel.sum(), mode="valid")


def between(start: Array, end: Array) -> Array:
    """The smallest rotation (N, 4) that turns directions `start` (N, 3) into those of `end`."""
    dot = np.vecdot(start, end)
    size = _size(start) * _size(end)
    return quat.normalise(
        np.concatenate([(size + dot)[..., None], quat.cross(start, end)], axis=-1)
    )


def bend_axis(thigh: Array, shank: Array, usual: Array) -> Array:
    """Unit axis (N, 3) about which the shank bends from the thigh; near straight, the usual one."""
    axis = quat.cross(thigh, shank)
    size = _size(thigh) * _size(shank)
    trusted = np.clip((_size(axis) / size - 0.02) / 0.1, 0.0, 1.0)[..., None]
    length = np.maximum(_size(axis)[..., None], 1e-12)
    mixed = trusted * axis / length + (1 - trusted) * usual
    return np.asarray(mixed / np.maximum(_size(mixed)[..., None], 1e-12))


def _eased(change: Array, room: Array) -> Array:
    """A lengthening (N,) that never exceeds its room and hardly differs where that is ample."""
    limit = np.maximum(room, 1e-9)
    return np.asarray(change * limit / (np.abs(change) ** 4 + limit**4) ** 0.25)


def _knee_angle(upper: Array, lower: Array, distance: Array) -> Array:
    """Angle (N,) from the thigh's direction to the shank's when hip and ankle are so far apart."""
    cosine = (distance**2 - upper**2 - lower**2) / (2 * upper * lower)
    return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)))


def _size(vectors: Array) -> Array:
    """Lengths (...,) of vectors (..., 3); on few of them twice as fast as NumPy's norm."""
    return np.asarray(np.sqrt(np.vecdot(vectors, vectors)))


def _turn(axis: Array, angle: Array) -> Array:
    return quat.exp(0.5 * angle[..., None] * axis)
