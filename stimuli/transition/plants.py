"""When a foot stands: found from the speed and the height of ankle and toe in a captured motion."""

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion, Skeleton

SPEED = 0.45  # metres a second below which a foot stands: heel roll and toe roll included
HEIGHT = 0.10  # metres above the lowest that the same point comes to
SHORTEST = 2  # frames
SIDES = ("left", "right")


@dataclass(frozen=True, eq=False)
class Leg:
    """The joints of a leg, and its toe: a joint, or an end site of the ankle."""

    hip: int
    knee: int
    ankle: int
    toe: Array  # (3,) from the ankle, in the ankle's frame

    @classmethod
    def of(cls, skeleton: Skeleton, side: str) -> "Leg":
        """The leg of a side; InputError naming roles that are missing."""
        hip, knee, ankle = skeleton.role(f"{side}_hip", f"{side}_knee", f"{side}_ankle")
        if f"{side}_toe" in skeleton.roles:
            toe = skeleton.offsets[skeleton.roles[f"{side}_toe"]]
        else:
            ends = skeleton.end_offsets[skeleton.end_parents == ankle]
            toe = ends[np.argmax(np.linalg.norm(ends, axis=1))] if len(ends) else np.zeros(3)
        return cls(hip, knee, ankle, toe)


@dataclass(frozen=True, eq=False)
class LegPose:
    """World positions (N, 3) and orientations (N, 4) down a leg."""

    hip: Array
    knee: Array
    ankle: Array
    toe: Array
    above: Array  # orientation of the joint that the hip hangs on
    thigh: Array
    shank: Array
    foot: Array


@dataclass(frozen=True, eq=False)
class Contacts:
    """For left and right: whether the foot stands (F, 2), and how far its toe bears it (F, 2).

    The part is 1 where the toe is still and the ankle moves, 0 where it is the other way round.
    """

    stands: np.ndarray
    on_toe: Array


def leg_pose(motion: Motion, leg: Leg, frames: slice) -> LegPose:
    """A leg in some frames of a motion, by its own chain alone."""
    skeleton, rotations = motion.skeleton, motion.rotations[frames]
    position, orientation = motion.root[frames], rotations[:, 0]
    above = orientation
    places, turns = {0: position}, {0: orientation}
    for link in skeleton.chain(leg.ankle)[1:]:
        above = orientation
        position = position + quat.rotate(orientation, skeleton.offsets[link])
        orientation = quat.multiply(orientation, rotations[:, link])
        places[link], turns[link] = position, orientation
        if link == leg.hip:
            bears = above
    if leg.hip == 0:
        bears = np.broadcast_to(quat.IDENTITY, rotations[:, 0].shape)
    toe = position + quat.rotate(orientation, leg.toe)
    return LegPose(
        places[leg.hip], places[leg.knee], position, toe,
        bears, turns[leg.hip], turns[leg.knee], orientation,
    )  # fmt: skip


_KNOWN: WeakKeyDictionary[Motion, Contacts] = WeakKeyDictionary()


def contacts(motion: Motion) -> Contacts:
    """When the feet of a captured motion stand; computed once for each motion."""
    if motion not in _KNOWN:
        _KNOWN[motion] = _found(motion)
    return _KNOWN[motion]


def _found(motion: Motion) -> Contacts:
    stands = np.zeros((len(motion), 2), dtype=bool)
    on_toe = np.zeros((len(motion), 2))
    for side, name in enumerate(SIDES):
        pose = leg_pose(motion, Leg.of(motion.skeleton, name), slice(None))
        speeds = [np.linalg.norm(quat.linear_velocity(p), axis=1) for p in (pose.ankle, pose.toe)]
        slow = [
            (speed * motion.fps < SPEED) & (p[:, 1] < np.quantile(p[:, 1], 0.05) + HEIGHT)
            for speed, p in zip(speeds, (pose.ankle, pose.toe), strict=True)
        ]
        stands[:, side] = _without_flicker(slow[0] | slow[1])
        on_toe[:, side] = (speeds[0] + 1e-6) / (speeds[0] + speeds[1] + 2e-6)
    return Contacts(stands, on_toe)


def runs(flags: np.ndarray) -> list[tuple[int, int]]:
    """First and last index of every run of true flags (F,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _without_flicker(flags: np.ndarray) -> np.ndarray:
    """Gaps and then runs shorter than the shortest plant are closed and dropped."""
    steady = flags.copy()
    for first, last in runs(~flags):
        if first > 0 and last < len(flags) - 1 and last - first + 1 < SHORTEST:
            steady[first : last + 1] = True
    for first, last in runs(steady):
        if last - first + 1 < SHORTEST:
            steady[first : last + 1] = False
    return steady
