"""From a file's units to metres."""

from collections.abc import Mapping

import numpy as np

from stimuli.motion.axes import bones_to, rest_positions
from stimuli.motion.formats.source import Take

UNITS = (1.0, 0.01, 0.001, 0.0254, 0.056444)  # metre, centi- and millimetre, inch, CMU's unit
STATURE = 1.7
PLAUSIBLE = (1.25, 2.1)


def stature(take: Take, roles: Mapping[str, int]) -> float | None:
    """Bone lengths from root to head with its End Site, plus root to ankle, in file units."""
    ankle = roles.get("left_ankle", roles.get("right_ankle"))
    if "head" not in roles or ankle is None:
        return None
    tops = take.end_offsets[take.end_parents == roles["head"]]
    crown = np.linalg.norm(tops, axis=1).max() if len(tops) else 0.0
    return float(bones_to(take, roles["head"]) + crown + bones_to(take, ankle))


def metres_per_unit(
    take: Take, roles: Mapping[str, int], scale: float | str
) -> tuple[float, str | None]:
    """Metres in a file unit; `scale` is that number or "auto"; a warning when it is a guess."""
    if not isinstance(scale, str):
        return float(scale), None
    height, doubt = stature(take, roles), None
    if height is None:
        extent = np.ptp(rest_positions(take.parents, take.offsets), axis=0)
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


def is_relative(take: Take, roles: Mapping[str, int], up: str) -> bool:
    """Whether the root's position channel is plainly relative to its OFFSET.

    So it is when OFFSET lies at leg height and the channel's median height near 0.
    """
    ankle = roles.get("left_ankle", roles.get("right_ankle"))
    if ankle is None:
        return False
    axis = "XYZ".index(up)
    leg = bones_to(take, ankle)
    offset, median = take.offsets[0, axis], float(np.median(take.root[:, axis]))
    return bool(0.7 * leg < offset < 1.4 * leg and abs(median) < 0.25 * leg)
