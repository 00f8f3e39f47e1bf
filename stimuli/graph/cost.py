"""How far apart two frames are as places to cut between (Arikan and Forsyth 2002, appendix A).

`C(s_i, t_j) = Σ_c M_c ‖D_c‖²/O_c + T_c ‖Ḋ_c‖²/L_c`: columns c are joints, the torso's velocity and
its turning, all in the torso frame; O_c and L_c are the largest squared norms of a column between
consecutive frames anywhere in the collection, so that a cost of 1 is what the fastest captured step
of one column of weight 1 would cost. C is a squared Euclidean distance between rows of 6 (K + 2)
numbers, and so all pairs are a matrix product.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from stimuli.collection import Collection, torso_features
from stimuli.motion.quaternions import Array
from stimuli.motion.roles import LIMBS
from stimuli.motion.skeleton import Motion, Skeleton
from stimuli.transition.distance import squared_euclidean

# M and T are not printed ("found empirically"). Ours: feet five times as much as hands, since the
# floor beside them shows what they do; knees, and what carries much of the body (hips, shoulders,
# trunk), between; the ends of arms and the head, which people see less, least. The torso's own
# velocity and turning tell a walk from a stand in one pose, and count like a foot. Rates (T) count
# half: they are noisier, and are there to keep a motion from being joined to its reverse. The size
# of all of them is such that a cost of 1, the default of the threshold, is three captured steps.
PLACES: Mapping[str, float] = MappingProxyType(
    {
        "pelvis": 1.0, "spine": 1.0, "chest": 1.0, "neck": 0.5, "head": 0.5,
        **{
            f"{side}_{limb}": weight
            for side in ("left", "right")
            for limb, weight in zip(LIMBS, (0.5, 1.0, 0.5, 0.5, 1.0, 1.75, 2.5, 2.5), strict=True)
        },
    }
)  # fmt: skip
_VELOCITY, _TURNING = 2.5, 2.5
RATES = 0.5  # of the same weights, for the rates of change
SMALLEST = 1e-6  # squared: a column that hardly moves anywhere counts by a millimetre a frame


@dataclass(frozen=True, eq=False)
class Metric:
    """The joints that are compared, and by what each column's difference is multiplied.

    `scale` and `rate_scale` (K + 2,) are √(M_c/O_c) and √(T_c/L_c).
    """

    joints: tuple[int, ...]
    scale: Array
    rate_scale: Array

    def rows(self, motion: Motion) -> Array:
        """Rows (F, 6 (K + 2)) of a motion whose squared distances are the cost."""
        features, rates = torso_features(motion, list(self.joints))
        scaled = [features * self.scale[:, None], rates * self.rate_scale[:, None]]
        return np.concatenate(scaled, axis=1).reshape(len(motion), -1)


def metric_of(collection: Collection) -> Metric:
    """The metric of a collection: O and L are the largest steps anywhere in it (eq. 3, 4)."""
    joints, weights = weighted_columns(collection.skeleton)
    most, most_rate = largest_steps(collection, joints)
    return Metric(
        joints,
        np.sqrt(weights / np.maximum(most, SMALLEST)),
        np.sqrt(RATES * weights / np.maximum(most_rate, SMALLEST)),
    )


def weighted_columns(skeleton: Skeleton) -> tuple[tuple[int, ...], Array]:
    """The joints that have a role, and the weights M (K + 2,) of their columns and the torso's."""
    roles = [role for role in PLACES if role in skeleton.roles]
    weights = [*(PLACES[role] for role in roles), _VELOCITY, _TURNING]
    return tuple(skeleton.roles[role] for role in roles), np.array(weights)


def largest_steps(collection: Collection, joints: tuple[int, ...]) -> tuple[Array, Array]:
    """O and L: the largest squared norm (K + 2,) of each column between consecutive frames."""
    each = [
        [np.square(np.diff(part, axis=0)).sum(axis=-1).max(axis=0) for part in both]
        for both in (torso_features(motion, list(joints)) for motion in collection.motions)
    ]
    return np.max([most for most, _ in each], axis=0), np.max([rate for _, rate in each], axis=0)


def cut_costs(a: Array, b: Array) -> Array:
    """C (FA, FB) between rows of two motions, in double precision."""
    middle = a.mean(axis=0)  # rows that lie around the origin lose no digits
    return np.asarray(squared_euclidean(a - middle, b - middle))
