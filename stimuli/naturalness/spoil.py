"""Captured motion spoiled by a known amount, where no labels of people are to be had.

A stand-in for unnatural motion, and named as one wherever it is used: a score that tells it from
captured motion need not tell what people see.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import headings
from stimuli.motion.quaternions import Array
from stimuli.motion.resample import resampled
from stimuli.motion.skeleton import Motion
from stimuli.naturalness.planted import own_plants
from stimuli.transition.footlock import feet_moved
from stimuli.transition.plants import leg_pose, legs_of
from stimuli.transition.weights import SIDES

_EASE = 4  # frames over which a foot goes back to where it was


def slid_feet(motion: Motion, metres: float, rng: np.random.Generator) -> Motion:
    """Each planted foot slides evenly by `metres`, in a direction of its own, while it stands."""
    shift = np.zeros((len(motion), len(SIDES), 3))
    for plant in own_plants(motion):
        angle = rng.uniform(0, 2 * np.pi)
        way = metres * np.array([np.cos(angle), 0.0, np.sin(angle)])
        part = np.linspace(0, 1, plant.last - plant.first + 1)
        shift[plant.first : plant.last + 1, plant.side] = part[:, None] * way
        after = np.arange(plant.last + 1, min(plant.last + 1 + _EASE, len(motion)))
        back = 1 - (after - plant.last) / (_EASE + 1)
        shift[after, plant.side] += back[:, None] * way
    pose = leg_pose(motion, slice(None))
    still = np.zeros(len(motion))
    rotations = feet_moved(motion.skeleton, motion.rotations, pose, shift, still)
    return Motion(motion.skeleton, rotations, motion.root, motion.fps)


def swayed_trunk(motion: Motion, degrees: float, rng: np.random.Generator) -> Motion:
    """The trunk tilts to the left or the right by `degrees`, and back, once; the feet stay."""
    part = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(len(motion)) / max(len(motion) - 1, 1))
    return _leaning(motion, degrees * rng.choice([-1.0, 1.0]) * part)


def tilted_trunk(motion: Motion, degrees: float, rng: np.random.Generator) -> Motion:
    """The trunk is tilted to the left or the right by `degrees` throughout; the feet stay.

    A lean that does not change is balanced as long as the feet are broad enough.
    """
    return _leaning(motion, degrees * rng.choice([-1.0, 1.0]) * np.ones(len(motion)))


def _leaning(motion: Motion, degrees: Array) -> Motion:
    """All above the legs leans to a side by `degrees` (F,)."""
    yaw = headings(motion)
    ahead = np.stack([np.sin(yaw), np.zeros(len(motion)), np.cos(yaw)], axis=-1)
    lean = quat.exp(0.5 * np.radians(degrees)[:, None] * ahead)
    rotations = motion.rotations.copy()
    rotations[:, 0] = quat.multiply(lean, rotations[:, 0])
    legs = legs_of(motion.skeleton)
    for top in {int(joint) for joint in legs.chain[1]}:  # what hangs on the root leans no more
        back = quat.multiply(quat.inverse(rotations[:, 0]), motion.rotations[:, 0])
        rotations[:, top] = quat.multiply(back, rotations[:, top])
    leaning = Motion(motion.skeleton, rotations, motion.root, motion.fps)
    pose = leg_pose(leaning, slice(None))
    shift = leg_pose(motion, slice(None)).ankle - pose.ankle
    rotations = feet_moved(motion.skeleton, rotations, pose, shift, np.zeros(len(motion)))
    return Motion(motion.skeleton, rotations, motion.root, motion.fps)


def warped_time(motion: Motion, factor: float, rng: np.random.Generator) -> Motion:
    """The motion played `factor` times as fast."""
    rotations, root = resampled(motion.rotations, motion.root, motion.fps * factor, motion.fps)
    return Motion(motion.skeleton, rotations, root, motion.fps)


Spoiler = Callable[[Motion, float, np.random.Generator], Motion]

SPOILERS: Mapping[str, tuple[Spoiler, tuple[float, ...], str]] = MappingProxyType(
    {
        "feet slid": (slid_feet, (0.02, 0.05, 0.1, 0.2), "m"),
        "trunk tilted and back": (swayed_trunk, (5.0, 10.0, 20.0), "°"),
        "trunk tilted throughout": (tilted_trunk, (5.0, 10.0, 20.0), "°"),
        "time warped": (warped_time, (1.25, 1.5, 2.0), "×"),
    }
)


def area_under_roc(natural: Array, spoiled: Array) -> float:
    """The chance that a spoiled motion scores higher than a natural one, ties counting half."""
    natural = np.sort(natural)
    below = np.searchsorted(natural, spoiled, side="left")
    at_most = np.searchsorted(natural, spoiled, side="right")
    return float((below + at_most).mean() / (2 * len(natural)))
