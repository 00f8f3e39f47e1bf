"""Which way knees bend: the sine of the angle from thigh to shank, below 0 where they bend back."""

import numpy as np

from stimuli.errors import InputError
from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion, Skeleton
from stimuli.transition.plants import legs_of

BACKWARDS = -0.1  # sine beyond which a knee is seen to bend backwards


def usual_hinges(motions: tuple[Motion, ...]) -> Array:
    """The axes (2, 3) about which knees are bent in motions of one skeleton, left one first.

    In the frames of the thighs; the frames in which a knee is most bent count most.
    """
    bends = np.zeros((2, 3))
    for motion in motions:
        thigh, shank = _bones(motion.skeleton, motion.rotations)
        bends += quat.cross(thigh, shank).sum(axis=0)
    size = quat.norm(bends)[:, None]
    return np.where(size > 0, bends / np.where(size > 0, size, 1.0), [1.0, 0.0, 0.0])


def knee_sines(skeleton: Skeleton, rotations: Array, hinges: Array) -> Array:
    """Sines (..., 2) of both knees, of poses (..., J, 4)."""
    thigh, shank = _bones(skeleton, rotations)
    size = quat.norm(thigh) * quat.norm(shank)
    return np.asarray(np.vecdot(quat.cross(thigh, shank), hinges) / size)


def has_legs(skeleton: Skeleton) -> bool:
    """Whether there are two legs alike whose knees can be asked."""
    try:
        legs_of(skeleton)
    except InputError:
        return False
    return True


def _bones(skeleton: Skeleton, rotations: Array) -> tuple[Array, Array]:
    """Thighs and shanks (..., 2, 3) in the frames of the thighs."""
    legs = legs_of(skeleton)
    below = legs.chain[legs.hip + 1 :]
    place = np.zeros((*rotations.shape[:-2], 2, 3))
    turn = np.broadcast_to(quat.IDENTITY, (*rotations.shape[:-2], 2, 4))
    places = []
    for joints in below:
        place = place + quat.rotate(turn, skeleton.offsets[joints])
        turn = quat.multiply(turn, rotations[..., joints, :])
        places.append(place)
    knee = places[legs.knee - legs.hip - 1]
    return knee, places[-1] - knee
