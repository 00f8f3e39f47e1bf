"""Poses between the frames: rotations by slerp, root by linear interpolation."""

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array

_AT_ONCE = 200_000  # rotations mixed in one go, which takes some twenty times their own memory


def sampled(rotations: Array, root: Array, places: Array) -> tuple[Array, Array]:
    """Poses at fractional frames `places` (N,), each within 0 … F−1: (N, J, 4) and (N, 3)."""
    before = np.clip(np.floor(places).astype(int), 0, len(root) - 1)
    after = np.minimum(before + 1, len(root) - 1)
    part = places - before
    if np.all(part == 0):
        return rotations[before], root[before]
    mixed = np.empty((len(places), *rotations.shape[1:]))
    step = max(1, _AT_ONCE // rotations.shape[1])
    for some in (slice(first, first + step) for first in range(0, len(places), step)):
        mixed[some] = quat.slerp(rotations[before[some]], rotations[after[some]], part[some, None])
    return mixed, root[before] + part[:, None] * (root[after] - root[before])


def resampled_length(frames: int, fps: float, to: float) -> int:
    """Frames of a motion of `frames` at `fps` once it is at the rate `to`."""
    return int(np.floor((frames - 1) * to / fps + 1e-6)) + 1


def resampled(rotations: Array, root: Array, fps: float, to: float) -> tuple[Array, Array]:
    """The motion at the rate `to`: frame k at k / to s, floor((F−1)·to/fps + 1e-6) + 1 frames."""
    places = np.minimum(
        np.arange(resampled_length(len(root), fps, to)) * (fps / to), len(root) - 1.0
    )
    snapped = np.round(places)
    return sampled(rotations, root, np.where(np.abs(places - snapped) < 1e-6, snapped, places))
