"""How far a clip lies from its group's reference outside the blend, where nothing should tell."""

import numpy as np

from stimuli.motion.kinematics import forward
from stimuli.motion.skeleton import Motion
from stimuli.sets.layout import LaidOut


def end_displacements(clip: LaidOut, reference: LaidOut) -> dict[str, float | None]:
    """Mean distance (metres) of a joint from where it is in the reference clip at the same frame.

    `displacement_before` is over the frames before either blend, `displacement_after` over those
    after both; None where there are no such frames.
    """
    apart = np.linalg.norm(_positions(clip.motion) - _positions(reference.motion), axis=-1)
    distance = apart.mean(axis=1)
    before = distance[: max(min(clip.mixed[0], reference.mixed[0]), 0)]
    after = distance[max(clip.mixed[1], reference.mixed[1]) + 1 :]
    return {
        "displacement_before": float(before.mean()) if len(before) else None,
        "displacement_after": float(after.mean()) if len(after) else None,
    }


def _positions(motion: Motion) -> np.ndarray:
    return forward(motion.skeleton, motion.rotations, motion.root)[0]
