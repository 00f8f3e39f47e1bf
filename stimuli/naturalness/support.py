"""What a body stands on: the soles of the feet that bear it, and how far a point lies beyond."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.transition.plants import LegPose, contacts, leg_pose

_HEEL = 0.05  # metres behind the ankle
_TIP = 0.06  # metres ahead of the toe joint
_HALF = 0.045  # metres to either side
# Seconds that a foot bears the body before it stands, on its heel, and after that, on its toes:
# too fast on the way to be told from a swing by its speed.
ROLLING = 0.13
_FLAT = np.array([0, 2])


@dataclass(frozen=True, eq=False)
class Support:
    """Corners (F, 2, 4, 2) of both soles on the floor, and which of them bear the body (F, 2, 4).

    `stands` (F, 2) are the frames in which a foot is planted; `floor` is the floor's height.
    """

    corners: Array
    bears: np.ndarray
    stands: np.ndarray
    floor: float


def support_of(motion: Motion, stands: np.ndarray | None = None) -> Support:
    """The soles of a motion; `stands` (F, 2) where it is known when its feet do."""
    if stands is None:
        stands = contacts(motion).stands
    pose = leg_pose(motion, slice(None))
    rolls = rolling(stands, motion.fps) & ~stands
    bears = stands[..., None] | (rolls[..., None] & _nearer_end(pose, stands))
    return Support(soles(pose), bears, stands, _floor(pose, stands))


def rolling(stands: np.ndarray, fps: float) -> np.ndarray:
    """Which foot bears the body (F, 2): the plants, and the rolling before and after them."""
    bears = stands.copy()
    for shift in range(1, round(ROLLING * fps) + 1):
        bears[shift:] |= stands[:-shift]
        bears[:-shift] |= stands[shift:]
    return bears


def _nearer_end(pose: LegPose, stands: np.ndarray) -> np.ndarray:
    """Corners (F, 2, 4) of that end of a sole, heel or tip, which is less lifted off the floor."""
    lifted = []
    for height in (pose.ankle[..., 1], pose.toe[..., 1]):
        standing = np.where(stands, height, np.nan)
        known = stands.any(axis=0)
        rest = np.full(2, height.min())
        rest[known] = np.nanmedian(standing[:, known], axis=0)
        lifted.append(height - rest)
    on_heel = lifted[0] <= lifted[1]
    return np.stack([on_heel, on_heel, ~on_heel, ~on_heel], axis=-1)


def soles(pose: LegPose) -> Array:
    """Corners (F, 2, 4, 2) of soles about the line from the ankle to the toe, as it lies above."""
    ankle, toe = pose.ankle[..., _FLAT], pose.toe[..., _FLAT]
    along = toe - ankle
    along = along / np.maximum(np.linalg.norm(along, axis=-1, keepdims=True), 1e-9)
    beside = _HALF * np.stack([-along[..., 1], along[..., 0]], axis=-1)
    heel, tip = ankle - _HEEL * along, toe + _TIP * along
    return np.stack([heel + beside, heel - beside, tip - beside, tip + beside], axis=2)


def _floor(pose: LegPose, stands: np.ndarray) -> float:
    """The height on which feet stand: of toes where they do, else the lowest that a foot comes."""
    lowest = np.minimum(pose.toe[..., 1], pose.ankle[..., 1])
    return float(np.median(lowest[stands]) if stands.any() else lowest.min())


def beyond_support(points: Array, support: Support) -> Array:
    """Metres (F,) from points (F, 2) to the hull of the soles that bear the body; 0 within it.

    NaN where no foot does, and where a point is NaN.
    """
    frames = len(points)
    corners = np.where(support.bears[..., None], support.corners, np.nan).reshape(frames, -1, 2)
    some = np.flatnonzero(support.bears.any(axis=(1, 2)) & np.isfinite(points).all(axis=1))
    distance = np.full(frames, np.nan)
    if len(some):
        distance[some] = _beyond(points[some], corners[some])
    return distance


def _beyond(points: Array, corners: Array) -> Array:
    """Distances (N,) of points (N, 2) from the hulls of corners (N, K, 2), some of them NaN.

    A point is within a hull where no half plane keeps all corners on one side of it; the hull's
    sides are among the lines between any two corners, and none of the others is nearer.
    """
    arms = corners - points[:, None]
    known = np.isfinite(arms[..., 0])
    first = np.take_along_axis(arms, known.argmax(axis=1)[:, None, None], axis=1)
    arms = np.where(known[..., None], arms, first)
    angles = np.sort(np.arctan2(arms[..., 1], arms[..., 0]), axis=1)
    gaps = np.diff(np.concatenate([angles, angles[:, :1] + 2 * np.pi], axis=1), axis=1)
    outside = gaps.max(axis=1) > np.pi
    nearest = np.full(len(points), np.inf)
    for one, other in combinations(range(arms.shape[1]), 2):
        side = arms[:, other] - arms[:, one]
        length = np.maximum(np.vecdot(side, side), 1e-18)
        along = np.clip(-np.vecdot(arms[:, one], side) / length, 0.0, 1.0)
        nearest = np.minimum(nearest, np.linalg.norm(arms[:, one] + along[:, None] * side, axis=1))
    return np.where(outside, nearest, 0.0)
