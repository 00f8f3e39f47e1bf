"""Weights of the pose cost from labelled transitions (Wang 2005, IV.2 and IV.3)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stimuli.errors import InputError
from stimuli.motion.quaternions import Array
from stimuli.motion.roles import LIMBS
from stimuli.motion.skeleton import Motion
from stimuli.transition.distance import check_pair, joint_rotations, joint_velocities, root_cost
from stimuli.transition.points import TRIVIAL, Point, cheapest
from stimuli.transition.weights import SIDES, Weights, tied

TRUNK = ("pelvis", "spine", "chest", "neck", "head")
PARTS = (*LIMBS, *TRUNK)


@dataclass(frozen=True, eq=False)
class Labelled:
    """A transition that somebody called good or bad."""

    a: Motion
    b: Motion
    i: int
    j: int
    good: bool


@dataclass(frozen=True, eq=False)
class Fit:
    """Weights of the parts, the largest scaled to one, and the sum of squares left."""

    parts: tuple[str, ...]
    weights: Array
    residual: float

    def by_role(self) -> Weights:
        """The weights by role, left and right alike."""
        both = dict(zip(self.parts, (float(w) for w in self.weights), strict=True))
        limbs = {part: weight for part, weight in both.items() if part in LIMBS}
        return tied(limbs, {part: weight for part, weight in both.items() if part in TRUNK})


@dataclass(frozen=True)
class Left:
    """One labelled transition left out: how far the best transition point moved without it.

    `without` is None where it cannot be left out, and `reason` says why.
    """

    row: int
    best: Point
    without: Point | None
    reason: str = ""

    @property
    def moved(self) -> int | None:
        """Frames by which the point moved, the larger of both motions' moves."""
        if self.without is None:
            return None
        return max(abs(self.best.i - self.without.i), abs(self.best.j - self.without.j))


def common_parts(motions: Sequence[Motion]) -> tuple[str, ...]:
    """Parts whose joints (both sides) every motion knows, each joint under one name."""
    known: list[str] = []
    for part in PARTS:
        roles = _roles(part)
        if all(set(roles) <= set(m.skeleton.roles) for m in motions):
            joints = {m.skeleton.roles[roles[0]] for m in motions[:1]}
            taken = {motions[0].skeleton.roles[_roles(other)[0]] for other in known}
            if not joints & taken:
                known.append(part)
    if not known:
        raise InputError("weights: expected joints known in every clip, found none.")
    return tuple(known)


def part_distances(
    a: Motion, b: Motion, parts: Sequence[str], velocity_weight: float = 1.0
) -> Array:
    """θ² + ν‖Δω‖² of every part (P, FA, FB), both sides together."""
    check_pair(a, b)
    distances = np.zeros((len(parts), len(a), len(b)))
    for row, part in enumerate(parts):
        for joint in a.skeleton.role(*_roles(part)):
            p, q = joint_rotations(a, [joint])[:, 0], joint_rotations(b, [joint])[:, 0]
            distances[row] += np.square(np.arccos(np.minimum(np.abs(p @ q.T), 1.0)))
            if velocity_weight:
                v, w = joint_velocities(a, [joint])[:, 0], joint_velocities(b, [joint])[:, 0]
                squares = np.square(v).sum(1)[:, None] + np.square(w).sum(1) - 2 * v @ w.T
                distances[row] += velocity_weight * np.maximum(squares, 0.0)
    return distances


def design_matrix(
    transitions: Sequence[Labelled], parts: Sequence[str], velocity_weight: float = 1.0
) -> tuple[Array, Array]:
    """A (N, P) and b (N,) of IV.5: differences of each part, 1 for bad and 0 for good."""
    rows = []
    for t in transitions:
        first, second = max(t.i - 1, 0), max(t.j - 1, 0)
        near = part_distances(t.a[first : t.i + 2], t.b[second : t.j + 2], parts, velocity_weight)
        rows.append(near[:, t.i - first, t.j - second])
    return np.array(rows), np.array([0.0 if t.good else 1.0 for t in transitions])


def fit_weights(differences: Array, labels: Array, parts: Sequence[str]) -> Fit:
    """Non-negative least squares of A w ≈ b, the largest weight scaled to one (IV.5).

    InputError where the labels say nothing: all alike, or no weight above 0.
    """
    from scipy.optimize import nnls

    if len(labels) < 2 or np.all(labels == labels[0]):
        raise InputError("weights: expected good and bad transitions, found one kind alone.")
    weights, norm = nnls(differences, labels)
    if not weights.max() > 0:
        raise InputError(
            "weights: expected bad transitions to differ more than good ones, found none that do."
        )
    return Fit(tuple(parts), weights / weights.max(), float(norm) ** 2)


def leave_one_out(
    transitions: Sequence[Labelled],
    parts: Sequence[str],
    velocity_weight: float = 1.0,
    other: tuple[Motion, Motion] | None = None,
    progress: Callable[[int], None] | None = None,
    *,
    before: int = 0,
    after: int = 0,
) -> tuple[list[Left], list[Left]]:
    """How far the best transition point moves when one labelled transition is left out (IV.3).

    The first list judges on the motions of the transition left out, the second on `other`, a
    motion (or pair) of another performer; empty without one. The best point has `before` frames
    before i and `after` behind j; InputError where a pair of motions has none such.
    """
    differences, labels = design_matrix(transitions, parts, velocity_weight)
    whole = fit_weights(differences, labels, parts)
    known: dict[tuple[int, int], tuple[Array, Array]] = {}

    def best(a: Motion, b: Motion, weights: Array) -> Point:
        key = (id(a), id(b))
        if key not in known:
            known.clear()  # one pair's matrices at a time
            known[key] = (part_distances(a, b, parts, velocity_weight),
                          root_cost(a, b, velocity_weight))  # fmt: skip
        distances, root = known[key]
        cost = root + np.tensordot(weights, distances, axes=1)
        found = cheapest(cost, before, after, TRIVIAL if a is b else -1)
        if found is None:
            raise InputError(
                f"weights: expected a transition point with {before} frames before it and {after} "
                f"after it, found none in motions of {len(a)} and {len(b)} frames."
            )
        return found

    def left(row: int, a: Motion, b: Motion) -> Left:
        weights, reason = fits[row]
        without = None if weights is None else best(a, b, weights)
        return Left(row, best(a, b, whole.weights), without, reason)

    rows = range(len(transitions))
    fits = [_fit_without(row, differences, labels, parts) for row in rows]
    own: list[Left] = []
    for row, t in enumerate(transitions):
        own.append(left(row, t.a, t.b))
        if progress:
            progress(row + 1)
    return own, [left(row, *other) for row in rows] if other else []


def _fit_without(
    row: int, differences: Array, labels: Array, parts: Sequence[str]
) -> tuple[Array | None, str]:
    """The weights (P,) without one row, or None and why it cannot be left out."""
    if np.count_nonzero(labels == labels[row]) == 1:
        return None, "the only one of its kind"
    kept = np.arange(len(labels)) != row
    try:
        return fit_weights(differences[kept], labels[kept], parts).weights, ""
    except InputError:  # both kinds are left, so that is what is wrong
        return None, "without it bad ones differ no more than good ones"


def _roles(part: str) -> tuple[str, ...]:
    return tuple(f"{side}_{part}" for side in SIDES) if part in LIMBS else (part,)


def summary(left: Sequence[Left]) -> Mapping[str, float | int | None]:
    """Of those that can be left out: how many, how many points did not move, mean and median.

    Mean and median of the frames moved are None where there is none such.
    """
    moved = [entry.moved for entry in left if entry.moved is not None]
    return {
        "count": len(moved),
        "unmoved": moved.count(0),
        "mean": float(np.mean(moved)) if moved else None,
        "median": float(np.median(moved)) if moved else None,
    }
