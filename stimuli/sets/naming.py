"""What names a clip: everything that decides what it shows, and no float that was computed for it.

Two processors differ in the last digits of what is drawn, and a number that lies at a rounding's
edge would fall to either side of it. So a clip's name is made of what goes in: the two motions as
they were read, to a quarter of a millimetre; the frames, the way of joining and the lengths, of all
clips that share a camera; the clip's layout in time and its look; and a number for the code that
makes pictures of them. Paths, file names and comments in files are no part of it, and a motion
read from another format has the name of the same motion.

- A changed motion file, or changed code that reads it: the motion as read changes.
- Changed code that joins, holds feet, dresses, lights or draws: `RECIPE` is raised by hand. A test
  holds what clips of this recipe show against figures that are kept with its number, and fails
  until it is.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.skeleton import Motion
from stimuli.transition import METHODS, Transition

RECIPE = 5  # raise it with any change of code that shows in a clip
DIGITS = 24  # of the hash that names a clip
# Its edges are odd multiples of 2⁻¹³, thirteen decimals long: a number that somebody wrote with six
# or fewer lies 1e-13 away from one at least, which is more than arithmetic differs by.
GRID = 2.0**-12  # of a metre, and of the axes of a rotation
ALIKE = 1e-6  # metres and half-angle radians: clips that differ by less are one and the same


def digest(document: Any) -> str:
    """SHA-256 of a JSON document in canonical form, in hexadecimal."""
    canonical = json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(canonical.encode()).hexdigest()


@lru_cache(maxsize=128)
def motion_digest(motion: Motion) -> str:
    """SHA-256 of a motion as it was read, rounded to the grid: body, roles, poses, and its cycle.

    A rotation counts by its axes, since a quaternion and its negative are one rotation.
    """
    body, sha = motion.skeleton, hashlib.sha256()
    whole = [body.parents.tolist(), body.end_parents.tolist(), sorted(body.roles.items()),
             motion.rotations.shape]  # fmt: skip
    sha.update(digest(whole).encode())
    parts = [body.offsets, body.end_offsets, quat.axes(motion.rotations), motion.root]
    if motion.cycle is not None:
        cycle = motion.cycle
        parts += [np.array([cycle.period]), quat.axes(cycle.rotations), cycle.root]
    for part in parts:
        sha.update(np.rint(part / GRID).astype("<i8").tobytes())
    return sha.hexdigest()


def joining(transition: Transition) -> dict[str, Any]:
    """The way two motions were joined and how long, alike for methods that share a way.

    The whole numbers of a method's report are what else a way goes by: windows, schedules. The
    pieces of a way through other motions are its clips, by name, and frames.
    """
    blend = METHODS[transition.method].blend
    way = next(name for name, method in METHODS.items() if method.blend is blend)
    chosen = {key: value for key, value in transition.report.items() if _whole(value)}
    through = {"pieces": transition.report["pieces"]} if METHODS[way].through else {}
    return {"way": way, "length": transition.frames, **chosen, **through}


def same_pictures(motions: Sequence[Motion]) -> list[int]:
    """For each motion of a group the first of them that nobody could tell from it."""
    firsts: list[int] = []
    for place, motion in enumerate(motions):
        earlier = [first for first in dict.fromkeys(firsts) if _alike(motions[first], motion)]
        firsts.append(earlier[0] if earlier else place)
    return firsts


def clip_names(made_of: Mapping[str, Any], joins: Sequence[Mapping[str, Any]]) -> list[str]:
    """Names of a group's clips, from what they have in common and how each is joined."""
    common = {"recipe": RECIPE, "group": list(joins), **made_of}
    return [digest({**common, "clip": join})[:DIGITS] for join in joins]


def _alike(one: Motion, other: Motion) -> bool:
    return len(one) == len(other) and bool(
        np.abs(one.root - other.root).max() < ALIKE
        and quat.geodesic(one.rotations, other.rotations).max() < ALIKE
    )


def _whole(value: Any) -> bool:
    """Whether a value is a whole number, or a table of them."""
    if isinstance(value, Mapping):
        return all(_whole(entry) for entry in value.values())
    return isinstance(value, int) and not isinstance(value, bool)
