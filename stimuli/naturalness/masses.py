"""The masses of a performer's segments, found from how the performer keeps balance.

Winter's table is of an average body. As Shin, Kovar and Gleicher (2003) and Ikemoto, Arikan and
Forsyth (2007, 7.2), the masses are optimised over captured motion, from the table on and held near
it, so that the zero moment point lies within the support where there is one.
"""

from collections.abc import Sequence

import numpy as np

from stimuli.errors import InputError
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.naturalness.dynamics import (
    BORNE,
    Moving,
    in_motion,
    well_derived,
    zero_moment_points,
)
from stimuli.naturalness.segments import BODY_PARTS, SEGMENTS, WINTER, segment_centres
from stimuli.naturalness.support import Support, beyond_support, support_of

_NOISE = 0.05  # metres beyond the support that half of a frame's cost is for
_HELD = 0.02  # of a frame's cost that masses e times the table's cost
_MOST = 4_000  # frames that are fitted to, evenly drawn
_KINDS = tuple(SEGMENTS)
_OF_PART = np.array([_KINDS.index(name) for name, _ in BODY_PARTS])


def fitted_masses(motions: Sequence[Motion]) -> Array:
    """Shares (S,) of `BODY_PARTS`, which sum to one, both sides alike.

    The least of b² / (b² + _NOISE²) for the metres b beyond the support, on average over frames,
    which frames far beyond it do not rule, and of the mean square of the logarithms of masses
    against the table's, times `_HELD`.
    InputError where no frame of any motion stands on a foot.
    """
    from scipy.optimize import minimize

    seen = [_supported(motion) for motion in motions if len(motion) >= 4]
    if not any(len(support.bears) for _, support in seen):
        raise InputError(
            "masses: expected motions of somebody on their feet, found none in which a foot "
            "stands.\nFit them to walks, or score with the table's (leave out the collection)."
        )
    drawn = [_some(moving, support, len(seen)) for moving, support in seen]

    def cost(logs: Array) -> float:
        masses = _shares(logs)
        beyond = np.concatenate([_beyond(moving, support, masses) for moving, support in drawn])
        return float(np.mean(beyond**2 / (beyond**2 + _NOISE**2)) + _HELD * np.mean(logs**2))

    found = minimize(cost, np.zeros(len(_KINDS)), method="L-BFGS-B", bounds=[(-1.5, 1.5)] * 7)
    return _shares(found.x)


def _shares(logs: Array) -> Array:
    masses = WINTER * np.exp(logs[_OF_PART])
    return np.asarray(masses / masses.sum())


def _supported(motion: Motion) -> tuple[Moving, Support]:
    """A motion and its soles in the frames in which a foot stands."""
    support = support_of(motion)
    moving = in_motion(segment_centres(motion), motion.fps)
    told = support.stands.any(axis=1) & well_derived(len(motion), motion.fps)
    return _part(moving, support, np.flatnonzero(told))


def _some(moving: Moving, support: Support, motions: int) -> tuple[Moving, Support]:
    """As many frames, evenly drawn, as one of so many motions may have."""
    count = min(max(_MOST // motions, 1), len(support.bears))
    return _part(moving, support, np.linspace(0, len(support.bears) - 1, count).round().astype(int))


def _part(moving: Moving, support: Support, frames: np.ndarray) -> tuple[Moving, Support]:
    return (
        Moving(moving.place[frames], moving.velocity[frames], moving.acceleration[frames]),
        Support(
            support.corners[frames], support.bears[frames], support.stands[frames], support.floor
        ),
    )


def _beyond(moving: Moving, support: Support, masses: Array) -> Array:
    points, borne = zero_moment_points(moving, masses, support.floor)
    return beyond_support(points[borne > BORNE], _bearing(support, borne > BORNE))


def _bearing(support: Support, frames: np.ndarray) -> Support:
    return Support(
        support.corners[frames], support.bears[frames], support.stands[frames], support.floor
    )
