"""When a foot stands: found from the speed and the height of ankle and toe in a captured motion."""

from dataclasses import dataclass
from functools import lru_cache
from weakref import WeakKeyDictionary

import numpy as np

from stimuli.errors import InputError
from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion, Skeleton
from stimuli.ties import first_least
from stimuli.transition.weights import SIDES

SPEED = 0.45  # metres a second below which a foot stands: heel roll and toe roll included
HEIGHT = 0.10  # metres above the lowest that the same point comes to
SHORTEST = 2  # frames
LEVEL = np.array([1.0, 0.0, 1.0])  # keeps what of a vector lies on the floor


@dataclass(frozen=True, eq=False)
class Legs:
    """Both legs of a skeleton, the left one first: their joints and their toes.

    A toe is a joint, or an end site of the ankle; `toes` (2, 3) lie in the ankles' frames.
    `chain` (D, 2) leads from the root down to the ankles; `hip` and `knee` are places in it.
    """

    chain: np.ndarray
    hip: int
    knee: int
    toes: Array

    @property
    def joints(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Hips (2,), knees (2,) and ankles (2,)."""
        return self.chain[self.hip], self.chain[self.knee], self.chain[-1]


@dataclass(frozen=True, eq=False)
class LegPose:
    """World positions (N, 2, 3) and orientations (N, 2, 4) down both legs."""

    hip: Array
    knee: Array
    ankle: Array
    toe: Array
    above: Array  # orientation of the joint that the hip hangs on
    thigh: Array
    shank: Array
    foot: Array


@lru_cache(maxsize=64)
def legs_of(skeleton: Skeleton) -> Legs:
    """The legs of a skeleton; InputError for missing roles and for legs of unlike hierarchies."""
    chains, toes = [], []
    for side in SIDES:
        hip, knee, ankle = skeleton.role(f"{side}_hip", f"{side}_knee", f"{side}_ankle")
        chain = skeleton.chain(ankle)
        chains.append((chain, chain.index(hip), chain.index(knee)))
        toes.append(_toe(skeleton, side, ankle))
    (left, hip, knee), (right, *places) = chains
    if len(left) != len(right) or [hip, knee] != places:
        raise InputError(
            f"skeleton of {skeleton.names[0]}: expected legs alike, found {len(left)} joints down "
            f"to the left ankle and {len(right)} to the right.\nFeet cannot be held: "
            "use --no-foot-lock."
        )
    legs = Legs(np.array([left, right]).T, hip, knee, np.array(toes))
    bones = np.linalg.norm(skeleton.offsets[legs.chain], axis=-1)
    if not (bones[legs.hip + 1 : legs.knee + 1].any(0) & bones[legs.knee + 1 :].any(0)).all():
        raise InputError(
            f"skeleton of {skeleton.names[0]}: expected thighs and shanks, found one without "
            "length.\nFeet cannot be held: use --no-foot-lock."
        )
    return legs


def _toe(skeleton: Skeleton, side: str, ankle: int) -> Array:
    """Where the toe is (3,), from the ankle."""
    if f"{side}_toe" in skeleton.roles:
        return skeleton.offsets[skeleton.roles[f"{side}_toe"]]
    ends = skeleton.end_offsets[skeleton.end_parents == ankle]
    return ends[first_least(-np.linalg.norm(ends, axis=1))] if len(ends) else np.zeros(3)


@dataclass(frozen=True, eq=False)
class Contacts:
    """For left and right: whether the foot stands (F, 2), and how far its toe bears it (F, 2).

    The part is 1 where the toe is still and the ankle moves, 0 where it is the other way round.
    `steps` (F, 2, 3) are those into every frame of what bears the foot, in the foot's own frame.
    """

    stands: np.ndarray
    on_toe: Array
    steps: Array


def leg_pose(motion: Motion, frames: slice) -> LegPose:
    """Both legs in some frames of a motion, by their own chains alone."""
    legs = legs_of(motion.skeleton)
    rotations, offsets = motion.rotations[frames], motion.skeleton.offsets
    position, orientation = motion.root[frames][:, None], rotations[:, legs.chain[0]]
    places, turns = [position], [orientation]
    for links in legs.chain[1:]:
        position = position + quat.rotate(orientation, offsets[links])
        orientation = quat.multiply(orientation, rotations[:, links])
        places.append(position)
        turns.append(orientation)
    return LegPose(
        hip=places[legs.hip],
        knee=places[legs.knee],
        ankle=position,
        toe=position + quat.rotate(orientation, legs.toes),
        above=turns[max(legs.hip - 1, 0)],
        thigh=turns[legs.hip],
        shank=turns[legs.knee],
        foot=orientation,
    )


def floor_steps(pose: LegPose, on_toe: Array) -> Array:
    """Steps (N, 2, 3) over the floor of that part of either foot that bears it; none into frame 0.

    `on_toe` (N, 2) is the toe's part.
    """
    steps = np.zeros_like(pose.ankle)
    part = 0.5 * (on_toe[1:] + on_toe[:-1])[..., None]
    steps[1:] = part * np.diff(pose.toe, axis=0) + (1 - part) * np.diff(pose.ankle, axis=0)
    return steps * LEVEL


_KNOWN: WeakKeyDictionary[Motion, Contacts] = WeakKeyDictionary()


def contacts(motion: Motion) -> Contacts:
    """When the feet of a captured motion stand; computed once for each motion."""
    if motion not in _KNOWN:
        _KNOWN[motion] = _found(motion)
    return _KNOWN[motion]


def _found(motion: Motion) -> Contacts:
    pose = leg_pose(motion, slice(None))
    slow, speeds = [], []
    for point in (pose.ankle, pose.toe):
        speed = np.linalg.norm(quat.linear_velocity(point), axis=-1)
        low = point[..., 1] < np.quantile(point[..., 1], 0.05, axis=0) + HEIGHT
        slow.append((speed * motion.fps < SPEED) & low)
        speeds.append((speed + 1e-6) ** 2)
    stands = (slow[0] | slow[1]).T
    steady = np.stack([without_flicker(side) for side in stands], axis=-1)
    on_toe = speeds[0] / (speeds[0] + speeds[1])
    steps = quat.rotate(quat.inverse(pose.foot), floor_steps(pose, on_toe))
    return Contacts(steady, on_toe, steps)


def spans(flags: np.ndarray) -> list[tuple[int, int]]:
    """First and last index of every run of true flags (F,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def without_flicker(flags: np.ndarray) -> np.ndarray:
    """Gaps and then runs shorter than the shortest plant are closed and dropped."""
    steady = flags.copy()
    for first, last in spans(~flags):
        if first > 0 and last < len(flags) - 1 and last - first + 1 < SHORTEST:
            steady[first : last + 1] = True
    for first, last in spans(steady):
        if last - first + 1 < SHORTEST:
            steady[first : last + 1] = False
    return steady
