"""Where feet should stand, and by how much they do not (Ikemoto, Arikan and Forsyth 2007, 7.1).

Plants of a motion made of others are those of its sources, each in the torso frame as it was, taken
in order of how close the foot comes to them and leaving out what overlaps. A motion of which
nothing else is known has its own.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import headings
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.transition.plants import contacts, leg_pose, spans
from stimuli.transition.weights import SIDES

_LEVEL = np.array([1.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Footplant:
    """A foot (0 left, 1 right) that should stand from frame `first` to `last`, both included.

    `places` (N, 2, 3) are where its ankle and its toe should be on the floor in each frame;
    `error` is the mean distance of the foot from there, metres.
    """

    side: int
    first: int
    last: int
    places: Array
    error: float


@dataclass(frozen=True, eq=False)
class Source:
    """A motion that another is made of: frame k of that shows this one's frame `frames[k]`.

    −1 where it shows nothing of this one.
    """

    motion: Motion
    frames: np.ndarray


def own_plants(motion: Motion) -> tuple[Footplant, ...]:
    """The plants of a motion as it is: each place is where its foot is on average.

    Of ankle and toe, each counts as far as it bears the foot.
    """
    known = contacts(motion)
    points = _feet(motion)
    found = []
    for side in range(len(SIDES)):
        for first, last in spans(known.stands[:, side]):
            part = points[first : last + 1, side]
            weight = _bearing(known.on_toe[first : last + 1, side])
            place = (weight[..., None] * part).sum(axis=0) / weight.sum(axis=0)[..., None]
            places = np.broadcast_to(place, part.shape)
            error = float(slides(part, places, weight).mean())
            found.append(Footplant(side, first, last, places, error))
    return tuple(sorted(found, key=lambda plant: (plant.first, plant.side)))


def carried_plants(motion: Motion, sources: Sequence[Source]) -> tuple[Footplant, ...]:
    """The plants of a motion made of others, out of all of theirs; in order of their first frame.

    Each source's plant stands where its torso had it; those nearest to the motion's own foot are
    taken first, and what overlaps one of the same foot already taken is left out.
    """
    points, home = _feet(motion), _torso(motion)
    offered: list[Footplant] = []
    for source in sources:
        offered += _offered(source, points, home)
    taken: list[Footplant] = []
    for plant in sorted(offered, key=lambda plant: (plant.error, plant.side, plant.first)):
        if not any(
            other.side == plant.side and other.first <= plant.last and plant.first <= other.last
            for other in taken
        ):
            taken.append(plant)
    return tuple(sorted(taken, key=lambda plant: (plant.first, plant.side)))


def _offered(source: Source, points: Array, home: tuple[Array, Array]) -> list[Footplant]:
    known, there = contacts(source.motion), own_plants(source.motion)
    origin, yaw = _torso(source.motion)
    shown = source.frames
    offered = []
    for plant in there:
        inside = (shown >= plant.first) & (shown <= plant.last)
        for first, last in spans(inside):
            at = shown[first : last + 1]
            places = plant.places[at - plant.first]
            turn = quat.about("Y", home[1][first : last + 1] - yaw[at])[:, None]
            moved = quat.rotate(turn, places - origin[at][:, None])
            moved = (moved + home[0][first : last + 1][:, None]) * _LEVEL
            weight = _bearing(known.on_toe[at, plant.side])
            off = slides(points[first : last + 1, plant.side], moved, weight)
            offered.append(Footplant(plant.side, first, last, moved, float(off.mean())))
    return offered


def slides(feet: Array, places: Array, weight: Array) -> Array:
    """Metres (N,) that feet (N, 2, 3), their ankles and toes, are off their places.

    `weight` (N, 2) is how far each of the two bears the foot.
    """
    off = np.linalg.norm((feet - places) * _LEVEL, axis=-1)
    return np.asarray((weight * off).sum(axis=-1))


def slid_by(motion: Motion, plants: Sequence[Footplant]) -> Array:
    """Metres (F, 2) that either foot is off where it should stand; NaN where it should not."""
    points, on_toe = _feet(motion), contacts(motion).on_toe
    off = np.full((len(motion), len(SIDES)), np.nan)
    for plant in plants:
        frames = slice(plant.first, plant.last + 1)
        weight = _bearing(on_toe[frames, plant.side])
        off[frames, plant.side] = slides(points[frames, plant.side], plant.places, weight)
    return off


def stands_by(plants: Sequence[Footplant], frames: int) -> np.ndarray:
    """Which foot should stand (F, 2)."""
    stands = np.zeros((frames, len(SIDES)), dtype=bool)
    for plant in plants:
        stands[plant.first : plant.last + 1, plant.side] = True
    return stands


def _feet(motion: Motion) -> Array:
    """Ankles and toes (F, 2, 2, 3) on the floor: frames, sides, ankle and toe."""
    pose = leg_pose(motion, slice(None))
    return np.stack([pose.ankle, pose.toe], axis=2) * _LEVEL


def _bearing(on_toe: Array) -> Array:
    """How far the ankle and the toe (N, 2) bear a foot, of the toe's part (N,)."""
    return np.stack([1 - on_toe, on_toe], axis=-1)


def _torso(motion: Motion) -> tuple[Array, Array]:
    """The root's places on the floor (F, 3) and headings (F,)."""
    return motion.root * _LEVEL, headings(motion)
