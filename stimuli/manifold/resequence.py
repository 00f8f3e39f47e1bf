"""Motion along ways through an embedding, decoded (Wang 2005, VII.2.2).

What an embedding of joint rotations does not hold is carried by the two frames nearest to each
place: the root's height and tilt, its steps over the floor and its turning, and which foot stands.
"""

from dataclasses import dataclass

import numpy as np

from stimuli.errors import InputError
from stimuli.manifold.decoder import PoseDecoder, two_nearest
from stimuli.manifold.embedding import Embedding
from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import headings
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.transition.align import on_skeleton
from stimuli.transition.footlock import feet_held
from stimuli.transition.plants import Contacts, contacts, without_flicker
from stimuli.transition.weights import SIDES

_SMOOTH = 1.5  # frames, the deviation by which what is carried is smoothed along a way
_LONGEST = 3600  # frames of a motion that is asked for


@dataclass(frozen=True, eq=False)
class Resequenced:
    """A motion decoded along a way: its places (F, d), and the frames drawn (S,) that it visits."""

    motion: Motion
    places: Array
    stops: np.ndarray


@dataclass(frozen=True, eq=False)
class _Carried:
    """Of every frame: height (N,), tilt (N, 4), step in its own heading (N, 2), turn (N,)."""

    height: Array
    tilt: Array
    step: Array
    turn: Array


def resequenced(
    embedding: Embedding, decoder: PoseDecoder, frames: int, generator: np.random.Generator
) -> Resequenced:
    """So many frames of motion along straight ways between frames drawn at random.

    The ways are gone at the motions' own speed, their median step. InputError for a length that is
    not to be had.
    """
    if not 4 <= frames <= _LONGEST:
        raise InputError(f"resequence: expected 4 to {_LONGEST} frames, found {frames}.")
    places = embedding.places[:, : decoder.dimensions]
    step = embedding.step(decoder.dimensions)
    stops, along, length = [int(generator.integers(len(places)))], [], 0.0
    while length < (frames - 1) * step:
        stops.append(int(generator.integers(len(places))))
        along.append(float(np.linalg.norm(places[stops[-1]] - places[stops[-2]])))
        length += along[-1]
    gone = np.concatenate([[0.0], np.cumsum(along)])
    wanted = step * np.arange(frames)
    columns = [np.interp(wanted, gone, column[stops]) for column in places.T]
    way = np.stack(columns, axis=1)
    return Resequenced(along_way(embedding, decoder, way), way, np.array(stops))


def straight_way(embedding: Embedding, dimensions: int, start: int, end: int) -> Array:
    """Places (n + 1, d) from one frame to another at the motions' own speed, both included."""
    places = embedding.places[:, :dimensions]
    far = float(np.linalg.norm(places[end] - places[start]))
    steps = max(round(far / embedding.step(dimensions)), 1)
    share = np.linspace(0.0, 1.0, steps + 1)[:, None]
    return np.asarray((1 - share) * places[start] + share * places[end])


def along_way(embedding: Embedding, decoder: PoseDecoder, way: Array, lock: bool = True) -> Motion:
    """The motion (F frames) decoded along places (F, d), on the body of the first clip."""
    skeleton = embedding.motions[0].skeleton
    motions = [on_skeleton(motion, skeleton) for motion in embedding.motions]
    places = embedding.places[:, : decoder.dimensions]
    first, other, share = two_nearest(way, places)
    known = _known(motions)
    one = _smoothed((1 - share) * known.turn[first] + share * known.turn[other])
    height = _smoothed((1 - share) * known.height[first] + share * known.height[other])
    part = share[:, None]
    step = _smoothed((1 - part) * known.step[first] + part * known.step[other])
    tilt = _smoothed(quat.continuous(quat.slerp(known.tilt[first], known.tilt[other], share)))
    yaw = np.concatenate([[0.0], np.cumsum(one[:-1])])
    root = np.zeros((len(way), 3))
    root[1:, 0] = np.cumsum(np.cos(yaw) * step[:, 0] + np.sin(yaw) * step[:, 1])[:-1]
    root[1:, 2] = np.cumsum(np.cos(yaw) * step[:, 1] - np.sin(yaw) * step[:, 0])[:-1]
    root[:, 1] = height
    whole = np.concatenate(
        [quat.multiply(quat.about("Y", yaw), quat.normalise(tilt))[:, None], decoder.poses(way)],
        axis=1,
    )
    motion = Motion(skeleton, quat.continuous(whole), root, motions[0].fps)
    if not lock:
        return motion
    known_feet = _feet(motions, first, other, share)
    return feet_held(motion, known_feet, 0, (0, len(way) - 1), np.ones(len(SIDES)))


def _known(motions: list[Motion]) -> _Carried:
    """What the root does in every frame; the last of a clip goes on as the one before."""
    parts = []
    for motion in motions:
        yaw = headings(motion)
        steps = np.diff(motion.root, axis=0)
        turned = quat.rotate(quat.about("Y", -yaw[:-1]), steps)[:, [0, 2]]
        turn = (np.diff(yaw) + np.pi) % (2 * np.pi) - np.pi
        tilt = quat.multiply(quat.about("Y", -yaw), motion.rotations[:, 0])
        parts.append((motion.root[:, 1], tilt, _held(turned), _held(turn)))
    height, tilt, step, turn = (np.concatenate(each) for each in zip(*parts, strict=True))
    return _Carried(height, tilt, step, turn)


def _held(steps: Array) -> Array:
    return np.concatenate([steps, steps[-1:]]) if len(steps) else np.zeros((1, *steps.shape[1:]))


def _smoothed(values: Array) -> Array:
    from scipy.ndimage import gaussian_filter1d

    return np.asarray(gaussian_filter1d(values, _SMOOTH, axis=0, mode="nearest"))


def _feet(motions: list[Motion], first: np.ndarray, other: np.ndarray, share: Array) -> Contacts:
    """The contacts that the nearest frames have."""
    each = [contacts(motion) for motion in motions]
    stands, on_toe, steps = (
        np.concatenate([getattr(known, name) for known in each])
        for name in ("stands", "on_toe", "steps")
    )
    steady = np.stack([without_flicker(side) for side in stands[first].T], axis=-1)
    part = share[:, None]
    return Contacts(steady, (1 - part) * on_toe[first] + part * on_toe[other], steps[first])
