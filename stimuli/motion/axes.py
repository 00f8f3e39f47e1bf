"""Which axis of a file is up, in its rest pose and in its motion, and turning both to +Y."""

from collections.abc import Mapping

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.formats.source import Take
from stimuli.motion.quaternions import Array
from stimuli.motion.roles import chain_to

TO_Y_UP = {"Y": quat.IDENTITY, "Z": quat.about("X", -np.pi / 2)}
_STANDS = 0.5  # of the body's length: what lies between head and ankles of one that stands
_FLOOR = (-0.1, 0.25)  # of a leg: where the lower ankle of one that stands is, from the floor
_LYING = (0.03, 0.45)  # of a leg: where the root of one that lies is
_MOST_FRAMES = 500  # that are asked


def rest_positions(parents: np.ndarray, offsets: Array) -> Array:
    """Joint positions (J, 3) with all rotations at identity and the root at the origin."""
    positions = np.zeros_like(offsets)
    for joint in range(1, len(parents)):
        positions[joint] = positions[parents[joint]] + offsets[joint]
    return positions


def rest_up(take: Take, roles: Mapping[str, int]) -> tuple[str, str | None]:
    """ "Y" or "Z", whichever separates head and ankles more in rest; a warning when in doubt."""
    rest = rest_positions(take.parents, take.offsets)
    ankles = [roles[side] for side in ("left_ankle", "right_ankle") if side in roles]
    if "head" in roles and ankles:
        apart = np.abs(rest[roles["head"]] - rest[ankles].mean(axis=0))
        return _longer(apart), None
    return _longer(np.ptp(rest, axis=0)), (
        "no head or ankles known: the up axis is the longer of Y and Z in the rest pose"
    )


def world_up(take: Take, roles: Mapping[str, int], rest: str) -> tuple[str, str | None]:
    """The up axis of the motion: that of its format or else of the rest pose, unless the body
    plainly stands on another; a warning then.

    Some exporters turn the body by its root rotation and leave the rest pose as it was, or rest
    with all bones along one axis. Such a body stands along the other axis with its feet at height
    0; one that lies there has its root a little above 0 by the rest pose's axis.
    """
    usual = take.world or rest
    other = "Z" if usual == "Y" else "Y"
    ankles = [roles[side] for side in ("left_ankle", "right_ankle") if side in roles]
    if "head" not in roles or not ankles:
        return usual, None
    leg = bones_to(take, ankles[0])
    tall = leg + bones_to(take, roles["head"])
    frames = slice(None, None, max(1, len(take.root) // _MOST_FRAMES))
    feet = np.stack([_places(take, joint, frames) for joint in ankles], axis=1)
    rise = np.median(_places(take, roles["head"], frames) - feet.mean(axis=1), axis=0)
    along, across = ("XYZ".index(axis) for axis in (usual, other))
    if rise[across] < _STANDS * tall:
        return usual, None
    places = rest_positions(take.parents, take.offsets)
    at_rest = places[roles["head"]] - places[ankles].mean(axis=0)
    if take.world is None and abs(at_rest[along]) < _STANDS * tall:
        return other, None  # a rest pose that does not stand tells nothing
    low = np.median(feet[..., across].min(axis=1))
    heights = take.root[frames, along]
    lies = np.mean((heights > _LYING[0] * leg) & (heights < _LYING[1] * leg)) > 0.9
    if lies or not _FLOOR[0] * leg < low < _FLOOR[1] * leg:
        return usual, None
    whose = f"{take.format} has {usual} up" if take.world else f"the rest pose has {usual} up"
    return other, f"{whose}, the body stands along {other}: taken as up"


def _places(take: Take, joint: int, frames: slice) -> Array:
    """Where a joint is in some frames (F, 3), in file units."""
    place, turn = take.root[frames], take.rotations[frames, 0]
    for link in chain_to(take.parents, joint)[1:]:
        place = place + quat.rotate(turn, take.offsets[link])
        turn = quat.multiply(turn, take.rotations[frames, link])
    return place


def _longer(apart: Array) -> str:
    return "Z" if apart[2] > apart[1] else "Y"


def bones_to(take: Take, joint: int) -> float:
    """Length of the bones from the root to a joint, in file units."""
    chain = chain_to(take.parents, joint)[1:]
    return float(np.linalg.norm(take.offsets[chain], axis=1).sum())


def upright(rotations: Array, root: Array, rest: str, world: str) -> tuple[Array, Array]:
    """Local rotations and root positions with +Y up, given the up axes of rest pose and world."""
    if rest == world == "Y":
        return rotations, root
    body, ground = TO_Y_UP[rest], TO_Y_UP[world]
    turned = quat.multiply(quat.multiply(body, rotations), quat.inverse(body))
    turned[:, 0] = quat.multiply(quat.multiply(ground, rotations[:, 0]), quat.inverse(body))
    return turned, quat.rotate(ground, root)
