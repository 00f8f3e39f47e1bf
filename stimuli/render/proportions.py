"""How long the shown body's trunk and arms are: as captured, or one standard for everybody.

Skeletons differ in what they call a trunk, and conversions make some of them short: those of CMU
data for MotionBuilder have short trunks and forearms. `standard` gives every figure the same
proportions to its own legs, which stay as they are, and with them its steps and where its feet
stand; its hands are then elsewhere than was captured. Only what is drawn is changed.

Lengths between the joints' centres are the means of women's and men's in de Leva (1996, table 4).
"""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from stimuli.errors import InputError
from stimuli.motion import quaternions as quat
from stimuli.motion.skeleton import Motion, Skeleton
from stimuli.render.landmarks import LEG_TO_STATURE, MIRRORED
from stimuli.render.reference import Reference, reference_pose

TRUNK_SHARE = 0.292  # of the stature, from the middle of the hips to that of the shoulders
ARMS = {"elbow": ("shoulder", 0.160), "wrist": ("elbow", 0.153)}  # end: (start, of the stature)
LEGS = (("hip", "knee"), ("knee", "ankle"))
_LEAST = 0.02  # metres: what is shorter is no bone that could be made longer


def captured(motion: Motion) -> Skeleton:
    """The bones that were captured."""
    return motion.skeleton


def standard(motion: Motion) -> Skeleton:
    """Trunk, upper arms and forearms as long as such legs have them in a standard body."""
    reference = reference_pose(motion)
    skeleton, at = reference.skeleton, reference.positions

    def length(start: str, end: str) -> float:
        first, last = skeleton.role(start, end)
        return float(np.linalg.norm(at[last] - at[first]))

    leg = sum(length(f"{side}_{a}", f"{side}_{b}") for side, _ in MIRRORED for a, b in LEGS) / 2
    stature = leg / LEG_TO_STATURE
    offsets = skeleton.offsets.copy()
    trunk = _trunk(skeleton)
    offsets[trunk] *= _trunk_factor(reference, trunk, TRUNK_SHARE * stature)
    for side, _ in MIRRORED:
        for end, (start, share) in ARMS.items():
            roles = f"{side}_{start}", f"{side}_{end}"
            if set(roles) <= set(skeleton.roles) and (long := length(*roles)) > _LEAST:
                above, whole = (skeleton.chain(joint) for joint in skeleton.role(*roles))
                offsets[whole[len(above) :]] *= share * stature / long
    return replace(skeleton, offsets=offsets)


PROPORTIONS: Mapping[str, Callable[[Motion], Skeleton]] = {
    "captured": captured,
    "standard": standard,
}


def shown_skeleton(motion: Motion, proportions: str) -> Skeleton:
    """The bones that are drawn; InputError for proportions that are not in the table."""
    if proportions not in PROPORTIONS:
        raise InputError(
            f"proportions: expected one of {', '.join(PROPORTIONS)}, found {proportions!r}."
        )
    return PROPORTIONS[proportions](motion)


def _trunk(skeleton: Skeleton) -> list[int]:
    """The joints above the hips that carry both shoulders."""
    shoulders = [skeleton.chain(j) for j in skeleton.role("left_shoulder", "right_shoulder")]
    hips = skeleton.chain(skeleton.role("left_hip")[0])
    return [joint for joint in shoulders[0] if joint in shoulders[1] and joint not in hips]


def _trunk_factor(reference: Reference, trunk: list[int], wanted: float) -> float:
    """What the trunk's bones are multiplied by, for the shoulders to be so far above the hips."""
    skeleton, at = reference.skeleton, reference.positions
    hips, shoulders = (
        np.mean([at[j][1] for j in skeleton.role(f"left_{part}", f"right_{part}")])
        for part in ("hip", "shoulder")
    )
    bones = quat.rotate(reference.orientations[skeleton.parents[trunk]], skeleton.offsets[trunk])
    high = float(bones[:, 1].sum())
    if high < _LEAST:
        return 1.0
    return max(1.0 + (wanted - float(shoulders - hips)) / high, 0.5)
