"""Two modern rivals that switch from one motion to the other at once and hide the switch.

Inertialization (Bollo 2018): from the switch on B alone is played, with the displacement from A and
its rate at the switch decaying on top. Dead blending (Holden 2023): each motion is used on its own
side of the switch, is extrapolated beyond it at its last velocity, and the two are cross-faded.
The switch is frame i (start-end), where the blend begins, or the instant (center-aligned).
"""

from collections.abc import Callable

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.transition.blend import interpolated_poses, smoothstep, spliced
from stimuli.transition.join import Join, Joined
from stimuli.transition.window import Window

HALF_LIFE = 3.0  # frames in which an extrapolated joint loses half its velocity
_SETTLED = 9.233  # (1 + x) exp(−x) is 0.001 there: a spring is at rest for the eye

Decay = Callable[[Array, Array, int], Array]


def decay_quintic(value: Array, rate: Array, frames: int) -> Array:
    """Offsets (frames, ...) from `value` at `rate` a frame to rest at `frames`, smooth at the end.

    The quintic with that start and no acceleration there, and with no value, speed or acceleration
    at the end.
    """
    s = _steps(value, frames) / frames
    falls = 1 - s**3 * (10 - 15 * s + 6 * s * s)
    drifts = s - s**3 * (6 - 8 * s + 3 * s * s)
    return np.asarray(falls * value + drifts * frames * rate)


def decay_spring(value: Array, rate: Array, frames: int) -> Array:
    """The same by a critically damped spring that is down to a thousandth after `frames`."""
    pull = _SETTLED / frames
    t = _steps(value, frames)
    return np.asarray((value + (rate + pull * value) * t) * np.exp(-pull * t))


def room_to_decay(window: Window, a: Motion, b: Motion) -> bool:
    """Whether B has the frames on which a displacement decays, from the switch on."""
    switch = window.anchor + window.lag
    return switch >= 0 and switch + window.frames <= len(b)


def room_to_extrapolate(window: Window, a: Motion, b: Motion) -> bool:
    """Whether A has its frames of the window before the switch, and B those from it on."""
    return (
        window.first >= 0 and window.anchor + window.lag >= 0 and window.last + window.lag < len(b)
    )


def join_inertialized(decay: Decay) -> Callable[[Join], Joined]:
    """The way of joining by inertialization with a decay."""

    def join_with(join: Join) -> Joined:
        window = join.fitting_window(room_to_decay)
        a, b = join.a, join.brought(window)
        here, there = join.i, join.i + window.lag
        turn, place = _displacement(a, b, here, there)
        turn_rate, place_rate = np.zeros_like(turn), np.zeros_like(place)
        if here > 0 and there > 0:
            before = _displacement(a, b, here - 1, there - 1)
            turn_rate, place_rate = turn - before[0], place - before[1]
        frames = window.frames
        rows = slice(there, there + frames)
        offset = quat.exp(decay(turn, turn_rate, frames))
        rotations = quat.multiply(b.rotations[rows], offset)
        root = b.root[rows] + decay(place, place_rate, frames)
        motion = spliced(a, b, here, there + frames, rotations, root)
        return Joined(motion, (here, here + frames - 1))

    return join_with


def join_dead(join: Join) -> Joined:
    """Both motions extrapolated beyond the switch, cross-faded over the specified window."""
    window = join.fitting_window(room_to_extrapolate)
    b = join.brought(window)
    here, there = join.i, join.i + window.lag
    ahead = np.arange(1, window.last - here + 1)
    behind = np.arange(window.first - here, 0)
    past_a, past_b = slice(window.first, here + 1), slice(there, window.last + window.lag + 1)
    beyond_a, beyond_b = _beyond(join.a, here, ahead), _beyond(b, there, behind)
    weights = smoothstep(window.weights) if join.smooth else window.weights
    rotations, root = interpolated_poses(
        np.concatenate([join.a.rotations[past_a], beyond_a[0]]),
        np.concatenate([join.a.root[past_a], beyond_a[1]]),
        np.concatenate([beyond_b[0], b.rotations[past_b]]),
        np.concatenate([beyond_b[1], b.root[past_b]]),
        weights,
    )
    motion = spliced(join.a, b, window.first, past_b.stop, rotations, root)
    return Joined(motion, (window.first, window.last))


def _displacement(a: Motion, b: Motion, here: int, there: int) -> tuple[Array, Array]:
    """How a frame of A lies from one of B: log(q_B⁻¹ q_A) of every joint, and the root's shift."""
    apart = quat.multiply(quat.inverse(b.rotations[there]), a.rotations[here])
    return quat.log(quat.shorter(apart)), a.root[here] - b.root[there]


def _beyond(motion: Motion, frame: int, steps: np.ndarray) -> tuple[Array, Array]:
    """Poses `steps` frames (all of one sign) from a frame, as its last velocity would have them.

    Velocities of joints and of the root's height decay; the root goes on over the floor.
    """
    side = 1 if len(steps) and steps[0] > 0 else -1
    known = min(max(frame - side, 0), len(motion) - 1)
    step = quat.multiply(quat.inverse(motion.rotations[known]), motion.rotations[frame])
    turn = quat.log(quat.shorter(step))
    drift = motion.root[frame] - motion.root[known]
    away = np.abs(steps).astype(float)
    reach = (1 - 0.5 ** (away / HALF_LIFE)) * HALF_LIFE / np.log(2)
    rotations = quat.multiply(motion.rotations[frame], quat.exp(reach[:, None, None] * turn))
    far = np.stack([away, reach, away], axis=-1)
    return rotations, motion.root[frame] + far * drift


def _steps(value: Array, frames: int) -> Array:
    """0 … frames − 1, shaped to broadcast over `value`."""
    return np.arange(frames, dtype=float).reshape(-1, *([1] * value.ndim))
