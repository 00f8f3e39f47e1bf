"""A body that sinks a little where its legs are too straight to reach where feet are held."""

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array

EASY = 0.992  # of a leg's whole length: as far as it reaches without being straightened
DEEPEST = 0.03  # metres that a body sinks at the most, about as far as in any step
_REACH = 5  # frames to either side over which it sinks, and as many for its smoothing


def sinking(hip: Array, knee: Array, ankle: Array, shift: Array) -> Array:
    """How far (N,) metres a body is to sink for its ankles to be moved by `shift`, smoothly.

    Positions and shift (N, 2, 3) of both legs. Nothing before and after ten frames around those in
    which a moved ankle lies farther from its hip than the leg easily reaches.
    """
    whole = quat.norm(knee - hip) + quat.norm(ankle - knee)
    now = quat.norm(ankle - hip)
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
