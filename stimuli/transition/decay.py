"""How an offset left by a switch decays (Bollo 2018), along the line on which it lies.

An offset has a size x₀ ≥ 0 and a speed v₀ a frame along its own direction. It never grows: a speed
that leads away counts as none, and one that leads to rest so fast that the offset would come out on
the other side shortens the decay. All functions work on arrays of offsets (N,).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from stimuli.motion.quaternions import Array

_SETTLED = 9.233  # (1 + x) exp(−x) is 0.001 there: a spring is at rest for the eye
_LEAST = 1e-9  # radians or metres; nothing to decay below
_EVEN = 1e-6  # frames; decays that differ by less are of one length

Decay = Callable[[Array, Array, Array, int], Array]


@dataclass(frozen=True, eq=False)
class Offsets:
    """Sizes (N,), their speeds as used, and the frames (N,) in which they decay."""

    sizes: Array
    speeds: Array
    lengths: Array
    leading_away: int


def clamped(sizes: Array, speeds: Array, frames: int) -> Offsets:
    """Offsets that do not grow, each over `frames` or, if that is less, −5 x₀ / v₀ frames."""
    away = (speeds > 0) & (sizes > _LEAST)
    used = np.where(sizes > _LEAST, np.minimum(speeds, 0.0), 0.0)
    fast = -used * frames > 5.0 * sizes
    lengths = np.where(fast, -5.0 * sizes / np.where(fast, used, -1.0), float(frames))
    return Offsets(sizes, used, np.maximum(lengths, _LEAST), int(np.sum(away & (speeds > 1e-6))))


def decay_quintic(sizes: Array, speeds: Array, lengths: Array, frames: int) -> Array:
    """Sizes (frames, N) on the quintic that starts with size, speed and an acceleration ≥ 0.

    It ends at its length with no size, speed and acceleration. The acceleration at the start is the
    one with which the third derivative is 0 at the end, where that is not negative.
    """
    s = np.minimum(_steps(frames) / lengths, 1.0)
    drift = speeds * lengths  # size, speed and acceleration, all in units of the decay's length
    pull = np.maximum(-8.0 * drift - 20.0 * sizes, 0.0)
    a = -0.5 * (pull + 6.0 * drift + 12.0 * sizes)
    b = 0.5 * (3.0 * pull + 16.0 * drift + 30.0 * sizes)
    c = -0.5 * (3.0 * pull + 12.0 * drift + 20.0 * sizes)
    path = ((((a * s + b) * s + c) * s + 0.5 * pull) * s + drift) * s + sizes
    return np.where(s < 1.0, path, 0.0)


def decay_spring(sizes: Array, speeds: Array, lengths: Array, frames: int) -> Array:
    """The same by a critically damped spring that is down to a thousandth after its length.

    It is stiff enough not to swing to the other side.
    """
    pull = _SETTLED / lengths
    falling = np.where(sizes > _LEAST, -speeds / np.maximum(sizes, _LEAST), 0.0)
    pull = np.maximum(pull, falling)
    t = _steps(frames)
    return np.asarray((sizes + (speeds + pull * sizes) * t) * np.exp(-pull * t))


def report(decay: Decay, offsets: Offsets, frames: int) -> Mapping[str, Any]:
    """What was used of each offset, for the manifest."""
    there = offsets.sizes > _LEAST
    shorter = there & (offsets.lengths < frames - _EVEN)
    shortest = float(np.min(offsets.lengths[there], initial=frames))
    return MappingProxyType(
        {
            "decay": decay.__name__.removeprefix("decay_"),
            "decays_shortened": int(np.sum(shorter)),
            "shortest_decay": round(shortest, 3),
            "speeds_leading_away": offsets.leading_away,
        }
    )


def _steps(frames: int) -> Array:
    """0 … frames − 1 (frames, 1)."""
    return np.arange(frames, dtype=float)[:, None]
