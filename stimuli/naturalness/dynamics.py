"""How point masses move: smoothed, their zero moment point, their angular momentum.

The zero moment point is where, on the floor, the moment of the forces from the ground has no level
part (Vukobratović and Juričić 1969; Ikemoto, Arikan and Forsyth 2007, 7.2).
"""

from dataclasses import dataclass

import numpy as np

from stimuli.motion.quaternions import Array

GRAVITY = 9.81  # metres a second squared
BORNE = 0.3  # of the weight: below, a body is as good as in flight, and the point runs away
SMOOTHED = 0.3  # seconds over which a cubic is fitted (Savitzky and Golay) before it is derived
_CUBIC = 3


@dataclass(frozen=True, eq=False)
class Moving:
    """Smoothed places (F, S, 3) of point masses, their velocities and accelerations, by seconds."""

    place: Array
    velocity: Array
    acceleration: Array


def half_window(fps: float) -> int:
    """Frames on either side over which a place is smoothed."""
    return round(0.5 * SMOOTHED * fps)


def well_derived(frames: int, fps: float) -> np.ndarray:
    """Which frames (F,) have whole windows about them, so that their accelerations are no guess.

    In motions of less than three windows all are taken as they are.
    """
    half = half_window(fps)
    told = np.ones(frames, dtype=bool)
    if frames >= 3 * (2 * half + 1):
        told[:half] = told[-half:] = False
    return told


def in_motion(places: Array, fps: float) -> Moving:
    """Places (F, S, 3) after a local cubic over `SMOOTHED` seconds, and its derivatives.

    At the ends the last cubics are followed (see `well_derived`). Shorter motions take the window
    that they have room for; fewer than four frames have no acceleration: ValueError.
    """
    from scipy.signal import savgol_filter

    frames = len(places)
    if frames < _CUBIC + 1:
        raise ValueError(f"{frames} frames have no acceleration")
    window = min(2 * half_window(fps) + 1, frames - (frames + 1) % 2)
    order = min(_CUBIC, window - 1)
    found = [
        savgol_filter(places, window, order, deriv=rate, delta=1 / fps, axis=0) for rate in range(3)
    ]
    return Moving(*found)


def zero_moment_points(moving: Moving, masses: Array, floor: float) -> tuple[Array, Array]:
    """The zero moment point (F, 2), x and z in metres, and the share of the weight borne (F,).

    `masses` (S,) of any unit, `floor` the floor's height. Nothing is told (NaN) where the ground
    bears nothing.
    """
    pushed = moving.acceleration[..., 1] + GRAVITY
    borne = pushed @ masses
    height = moving.place[..., 1] - floor
    points = []
    for axis in (0, 2):
        moment = pushed * moving.place[..., axis] - moving.acceleration[..., axis] * height
        with np.errstate(divide="ignore", invalid="ignore"):
            points.append(np.where(borne > 0, moment @ masses / borne, np.nan))
    return np.stack(points, axis=-1), borne / (GRAVITY * masses.sum())


def centre_of_mass(places: Array, masses: Array) -> Array:
    """The common centre (F, 3) of places (F, S, 3)."""
    return np.einsum("fsk,s->fk", places, masses / masses.sum())


def angular_momentum(moving: Moving, masses: Array) -> Array:
    """About the centre of mass, by the body's mass: (F, 3), square metres a second.

    Nothing changes it in flight.
    """
    arm = moving.place - centre_of_mass(moving.place, masses)[:, None]
    drift = moving.velocity - centre_of_mass(moving.velocity, masses)[:, None]
    return np.einsum("fsk,s->fk", np.cross(arm, drift), masses / masses.sum())
