"""Where legs are too short to hold a foot: the body sinks a little, then it is held in part."""

import numpy as np
from scipy.ndimage import convolve1d, maximum_filter1d

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array

EASY = 0.992  # of a leg's whole length: as far as it reaches without being straightened
DEEPEST = 0.03  # metres that a body sinks at the most, about as far as in any step
ANKLE_REACH = 0.5  # of its distance from the hip: a foot is moved no farther than this
SHORT = 0.01  # metres out of reach from which on a place is not held at all
NO_SINKING = 1e-6  # metres for which no body sinks
SINKING = 10  # frames over which it sinks and rises
_SOFT = np.hanning(SINKING + 3)[1:-1] / np.hanning(SINKING + 3).sum()


def sinking(leg: Array, whole: Array, shift: Array, start: int) -> Array:
    """How far (N,) metres a body is to sink for its ankles to be moved by `shift`, smoothly.

    `leg` (N, 2, 3) leads from the hips to the ankles, `whole` (N, 2) is how long the legs are when
    straight, `shift` (N, 2, 3). Nothing before and after SINKING frames around those
    in which a moved ankle lies farther from its hip than the leg easily reaches, from frame `start`
    on.
    """
    now, away = quat.norm(leg), leg + shift
    across = np.square(away[..., 0]) + np.square(away[..., 2])
    allowed = np.square(np.maximum(now, EASY * whole))
    above = np.sqrt(np.maximum(allowed - across, 0.0))
    needed = np.where(np.any(shift != 0, axis=-1), -away[..., 1] - above, 0.0).max(axis=1)
    needed = np.clip(needed - NO_SINKING, 0.0, DEEPEST)
    needed[:start] = 0.0
    if not needed.any():
        return needed
    largest = maximum_filter1d(needed, len(_SOFT), mode="nearest")
    return np.asarray(convolve1d(largest, _SOFT, mode="nearest"))


def reached(leg: Array, whole: Array, shift: Array, drop: Array) -> tuple[Array, Array]:
    """What legs reach of `shift` (N, 2, 3) along the floor from a body that sank by `drop` (N,).

    And how far (N, 2) that is short of it: 0 where it is all of it, 1 from SHORT metres on. A foot
    that were placed beyond would leave the floor. A body sinks to where a leg just reaches, which
    rounding makes a little more or less: so nothing hangs on whether anything is missing, only on
    how much.
    """
    now, size = quat.norm(leg), quat.norm(shift)
    part = ANKLE_REACH * now / np.maximum(size, 1e-9)
    lowered = leg.copy()
    lowered[..., 1] += drop[:, None]
    room = np.square(np.maximum(now, EASY * whole)) - np.square(quat.norm(lowered))
    along = np.vecdot(lowered, shift) / np.maximum(size, 1e-9)
    # the larger root of |lowered + part · shift|² = allowed²
    root = (_gentle_root(along**2 + room) - along) / np.maximum(size, 1e-9)
    part = np.clip(np.minimum(part, root), 0.0, 1.0)
    return part[..., None] * shift, np.minimum((1.0 - part) * size / SHORT, 1.0)


def _gentle_root(square: Array) -> Array:
    """Square root (N, 2) that goes on straight, metres, to nothing where a place is out of reach.

    A root itself would turn the last digits of a place that is just out of reach into millimetres.
    """
    edge = SHORT**2
    line = np.maximum(square + edge, 0.0) / (2 * SHORT)
    return np.where(square > edge, np.sqrt(np.maximum(square, edge)), line)
