"""The body as point masses: segments between joints, with the masses of Winter's table.

Winter, Biomechanics and Motor Control of Human Movement (2009), Table 4.1: the mass of a segment as
a share of the body's, and where its centre lies from its near end.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from stimuli.motion.kinematics import end_positions, forward
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.transition.plants import leg_pose
from stimuli.transition.weights import SIDES


@dataclass(frozen=True)
class Segment:
    """A part of the body: its share of the mass, and of its length from the near end to its centre.

    `near` and `far` name points of `_points`; where there are two, both sides have one.
    """

    near: str
    far: str
    mass: float
    centre: float
    sided: bool = True


SEGMENTS: Mapping[str, Segment] = MappingProxyType(
    {
        "trunk": Segment("hips", "shoulders", 0.497, 0.50, sided=False),
        "head and neck": Segment("head", "top", 0.081, 0.50, sided=False),
        "upper arm": Segment("shoulder", "elbow", 0.028, 0.436),
        "forearm and hand": Segment("elbow", "wrist", 0.022, 0.682),
        "thigh": Segment("hip", "knee", 0.100, 0.433),
        "shank": Segment("knee", "ankle", 0.0465, 0.433),
        "foot": Segment("ankle", "toe", 0.0145, 0.50),
    }
)
BODY_PARTS = tuple(
    (name, side) for name, part in SEGMENTS.items() for side in (SIDES if part.sided else ("",))
)
WINTER: Array = np.array([SEGMENTS[name].mass for name, _ in BODY_PARTS])
_HEAD = 0.35  # of the way from the shoulders to the hips: how tall a head without an end is


def segment_centres(motion: Motion) -> Array:
    """Where the centre of each of `BODY_PARTS` is, (F, S, 3) metres.

    InputError naming the roles that no joint plays: head, shoulders, elbows, wrists and legs.
    """
    points = _points(motion)
    centres = [
        points[side, part.near] + part.centre * (points[side, part.far] - points[side, part.near])
        for name, side in BODY_PARTS
        for part in [SEGMENTS[name]]
    ]
    return np.stack(centres, axis=1)


def _points(motion: Motion) -> dict[tuple[str, str], Array]:
    """Places (F, 3) by side and name."""
    skeleton = motion.skeleton
    positions, orientations = forward(skeleton, motion.rotations, motion.root)
    legs = leg_pose(motion, slice(None))
    points: dict[tuple[str, str], Array] = {}
    for place, side in enumerate(SIDES):
        names = ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")
        joints = skeleton.role(*(f"{side}_{name}" for name in names))
        points |= {
            (side, name): positions[:, joint] for name, joint in zip(names, joints, strict=True)
        }
        points[side, "toe"] = legs.toe[:, place]
    for name in ("hip", "shoulder"):
        points["", f"{name}s"] = 0.5 * (points["left", name] + points["right", name])
    (head,) = skeleton.role("head")
    points["", "head"] = positions[:, head]
    ends = end_positions(skeleton, positions, orientations)[:, skeleton.end_parents == head]
    up = points["", "shoulders"] - points["", "hips"]
    tops = [ends.mean(axis=1)] if ends.shape[1] else [points["", "head"] + _HEAD * up]
    points["", "top"] = tops[0]
    return points
