"""From a file's axes and units to metres with +Y up."""

from collections.abc import Mapping

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.formats.source import Source
from stimuli.motion.quaternions import Array

UNITS = (1.0, 0.01, 0.0254, 0.056444)  # metre, centimetre, inch, CMU's unit
STATURE = 1.7
PLAUSIBLE = (1.25, 2.1)
UPRIGHT = {"Y": quat.IDENTITY, "Z": quat.about("X", -np.pi / 2)}


def rest_positions(parents: np.ndarray, offsets: Array) -> Array:
    """Joint positions (J, 3) with all rotations at identity and the root at the origin."""
    positions = np.zeros_like(offsets)
    for joint in range(1, len(parents)):
        positions[joint] = positions[parents[joint]] + offsets[joint]
    return positions


def rest_up(source: Source, roles: Mapping[str, int]) -> tuple[str, str | None]:
    """ "Y" or "Z", whichever separates head and ankles more in rest; a warning when in doubt."""
    rest = rest_positions(source.parents, source.offsets)
    ankles = [roles[side] for side in ("left_ankle", "right_ankle") if side in roles]
    if "head" in roles and ankles:
        apart = np.abs(rest[roles["head"]] - rest[ankles].mean(axis=0))
        return _longer(apart), None
    return _longer(np.ptp(rest, axis=0)), (
        "no head or ankles known: the up axis is the longer of Y and Z in the rest pose"
    )


def world_up(source: Source, roles: Mapping[str, int], rest: str) -> tuple[str, str | None]:
    """The up axis of the motion: that of the rest pose, unless the body plainly stands on another.

    Some exporters turn the body by its root rotation and leave the rest pose as it was. Then the
    pelvis lies at height 0 by the rest pose's axis and at leg height by the other one.
    """
    other = "Z" if rest == "Y" else "Y"
    ankle = roles.get("left_ankle", roles.get("right_ankle"))
    if ankle is None:
        return rest, None
    leg = _reach(source, ankle)
    low, high = (abs(float(np.median(source.root[:, "XYZ".index(up)]))) for up in (rest, other))
    if not (low < 0.05 * leg and 0.8 * leg < high < 1.25 * leg):
        return rest, None
    return other, f"the rest pose stands along {rest}, the motion along {other}: taken as up"


def _longer(apart: Array) -> str:
    return "Z" if apart[2] > apart[1] else "Y"


def stature(source: Source, roles: Mapping[str, int]) -> float | None:
    """Bone lengths from root to head with its End Site, plus root to ankle, in file units."""
    ankle = roles.get("left_ankle", roles.get("right_ankle"))
    if "head" not in roles or ankle is None:
        return None
    tops = source.end_offsets[source.end_parents == roles["head"]]
    crown = np.linalg.norm(tops, axis=1).max() if len(tops) else 0.0
    return float(_reach(source, roles["head"]) + crown + _reach(source, ankle))


def _reach(source: Source, joint: int) -> float:
    """Length of the bones from the root to a joint."""
    length = 0.0
    while source.parents[joint] >= 0:
        length += float(np.linalg.norm(source.offsets[joint]))
        joint = int(source.parents[joint])
    return length


def metres_per_unit(
    source: Source, roles: Mapping[str, int], scale: float | str
) -> tuple[float, str | None]:
    """Metres in a file unit; `scale` is that number or "auto"; a warning when it is a guess."""
    if not isinstance(scale, str):
        return float(scale), None
    height, doubt = stature(source, roles), None
    if height is None:
        extent = np.ptp(rest_positions(source.parents, source.offsets), axis=0)
        height = float(extent.max())
        doubt = "no head or ankles known: the scale is told from the extent of the rest pose"
    if height <= 0:
        return 1.0, "the skeleton has no size: taken as metres; give its scale"
    unit = min(UNITS, key=lambda candidate: abs(candidate * height - STATURE))
    if PLAUSIBLE[0] <= unit * height <= PLAUSIBLE[1]:
        return unit, doubt
    return STATURE / height, (
        f"no known unit makes a body of {height:g} file units between {PLAUSIBLE[0]} and "
        f"{PLAUSIBLE[1]} m tall: scaled to {STATURE} m; give its scale if that is wrong"
    )


def is_relative(source: Source, roles: Mapping[str, int], up: str) -> bool:
    """Whether the root's position channel is plainly relative to its OFFSET.

    So it is when OFFSET lies at leg height and the channel's median height near 0.
    """
    ankle = roles.get("left_ankle", roles.get("right_ankle"))
    if ankle is None:
        return False
    axis = "XYZ".index(up)
    leg = _reach(source, ankle)
    offset, median = source.offsets[0, axis], float(np.median(source.root[:, axis]))
    return bool(0.7 * leg < offset < 1.4 * leg and abs(median) < 0.25 * leg)


def upright(rotations: Array, root: Array, rest: str, world: str) -> tuple[Array, Array]:
    """Local rotations and root positions with +Y up, given the up axes of rest pose and world."""
    if rest == world == "Y":
        return rotations, root
    body, ground = UPRIGHT[rest], UPRIGHT[world]
    turned = quat.multiply(quat.multiply(body, rotations), quat.inverse(body))
    turned[:, 0] = quat.multiply(quat.multiply(ground, rotations[:, 0]), quat.inverse(body))
    return turned, quat.rotate(ground, root)
