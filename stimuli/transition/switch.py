"""Two modern rivals that switch from one motion to the other at once and hide the switch.

Inertialization (Bollo 2018): from the switch on B alone is played, with what A differs from it at
the switch decaying on top. Dead blending (Holden 2023): each motion is used on its own side of the
switch, is extrapolated beyond it at its last velocity, and the two are cross-faded.
The switch is frame i (start-end), where the blend begins, or the instant (center-aligned).
"""

from collections.abc import Callable
from types import MappingProxyType

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.transition.blend import interpolated_poses, smoothstep, spliced
from stimuli.transition.decay import Decay, Offsets, clamped, report
from stimuli.transition.join import Join, Joined
from stimuli.transition.knees import BACKWARDS, has_legs, knee_sines, usual_hinges
from stimuli.transition.plants import SIDES
from stimuli.transition.window import Window

HALF_LIFE = 3.0  # frames in which an extrapolated joint loses half its velocity
_SAFE = 0.8  # of the sine at which a knee is seen to bend backwards: as far as one may go


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
    """The way of joining by inertialization with a decay.

    Each joint's offset is an angle about one axis, and decays as such; so does the root's height.
    A knee's decays sooner where it would be bent backwards on B.

    A departure from what was published, as the report says: over the floor, where alignment leaves
    no offset, the root keeps A's speed, though that leads away; it decays on a quintic, on which
    the root strays from B's by at most 16/81 of the way that the speed apart would take it.
    """

    def join_with(join: Join) -> Joined:
        window = join.fitting_window(room_to_decay)
        a, b = join.a, join.brought(window)
        here, there, frames = join.i, join.i + window.lag, window.frames
        rows = slice(there, there + frames)
        axes, offsets = _angles(a, b, here, there, frames)
        rise, height = _rise(a, b, here, there, frames)

        def turned(found: Offsets) -> Array:
            angles = decay(found.sizes, found.speeds, found.lengths, frames)
            return quat.multiply(b.rotations[rows], quat.exp(angles[..., None] * axes))

        played = np.concatenate([a.rotations[here : here + 1], b.rotations[rows]])
        offsets, righted = _righted(join, played, turned, offsets)
        drift = _drift(a, b, here, there, frames)
        root = b.root[rows] + drift
        root[:, 1] += rise * decay(height.sizes, height.speeds, height.lengths, frames)[:, 0]
        motion = spliced(a, b, here, there + frames, turned(offsets), root)
        used = dict(report(decay, offsets, frames)) | {
            "knees_righted": righted,
            "root_over_floor": "keeps the speed of A, a departure from Bollo 2018",
            "root_strays_metres": round(float(quat.norm(drift).max()), 3),
        }
        return Joined(motion, (here, here + frames - 1), report=MappingProxyType(used))

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


def _angles(a: Motion, b: Motion, here: int, there: int, frames: int) -> tuple[Array, Offsets]:
    """The axes (J, 3) about which A's joints are turned from B's at the switch; half the angles.

    The speed is how that turn about the same axis has changed since the frame before.
    """
    apart = quat.log(_apart(a, b, here, there))
    sizes = quat.norm(apart)
    axes = apart / np.where(sizes > 0, sizes, 1.0)[:, None]
    speeds = np.zeros_like(sizes)
    if here > 0 and there > 0:
        before = _apart(a, b, here - 1, there - 1)
        speeds = sizes - np.arctan2(np.vecdot(before[:, 1:], axes), before[:, 0])
    return axes, clamped(sizes, speeds, frames)


def _apart(a: Motion, b: Motion, here: int, there: int) -> Array:
    """How A's joints are turned (J, 4) from those of B, on the shorter arc."""
    return quat.shorter(quat.multiply(quat.inverse(b.rotations[there]), a.rotations[here]))


def _rise(a: Motion, b: Motion, here: int, there: int, frames: int) -> tuple[float, Offsets]:
    """Whether A's root is higher than B's (1) or lower (−1), and by how much."""
    apart = float(a.root[here, 1] - b.root[there, 1])
    side = 1.0 if apart >= 0 else -1.0
    before = apart
    if here > 0 and there > 0:
        before = float(a.root[here - 1, 1] - b.root[there - 1, 1])
    return side, clamped(np.array([side * apart]), np.array([side * (apart - before)]), frames)


def _drift(a: Motion, b: Motion, here: int, there: int, frames: int) -> Array:
    """How far (F, 3) over the floor the root is from B's, which it joins without a jerk."""
    apart = a.root[here] - b.root[there]
    rate = np.zeros(3)
    if here > 0 and there > 0:
        rate = apart - (a.root[here - 1] - b.root[there - 1])
    s = (np.arange(frames) / frames)[:, None]
    falls = 1 - s**3 * (10 - 15 * s + 6 * s * s)
    drifts = s - s**3 * (6 - 8 * s + 3 * s * s)
    over_floor = np.array([1.0, 0.0, 1.0])
    return np.asarray(over_floor * (falls * apart + drifts * frames * rate))


def _righted(
    join: Join, played: Array, turned: Callable[[Offsets], Array], offsets: Offsets
) -> tuple[Offsets, int]:
    """Offsets of which a knee's decays as soon as it must for the knee not to bend backwards.

    And how many knees that concerns. A knee may bend back as far as it does in what is `played`
    (F, J, 4): A's frame of the switch and B's from there on.
    """
    skeleton = join.a.skeleton
    if not has_legs(skeleton):
        return offsets, 0
    hinges = usual_hinges((join.a, join.b))
    least = np.minimum(_SAFE * BACKWARDS, knee_sines(skeleton, played, hinges).min(axis=0))
    bent = knee_sines(skeleton, turned(offsets), hinges).min(axis=0) < least
    knees = skeleton.role(*(f"{side}_knee" for side in SIDES))
    for side in np.flatnonzero(bent):
        for length in range(int(np.ceil(offsets.lengths[knees[side]])) - 1, 0, -1):
            lengths = offsets.lengths.copy()
            lengths[knees[side]] = length
            offsets = Offsets(offsets.sizes, offsets.speeds, lengths, offsets.leading_away)
            if knee_sines(skeleton, turned(offsets), hinges)[:, side].min() >= least[side]:
                break
    return offsets, int(bent.sum())


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
