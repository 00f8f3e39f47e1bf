"""Weights of the pose cost from labelled transitions (Wang 2005, IV.2 and IV.3)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stimuli.errors import InputError
from stimuli.motion.quaternions import Array
from stimuli.motion.roles import LIMBS
from stimuli.motion.skeleton import Motion
from stimuli.transition.distance import check_pair, joint_rotations, joint_velocities, root_cost
from stimuli.transition.points import Point, cheapest
from stimuli.transition.weights import SIDES, Weights, tied

TRUNK = ("pelvis", "spine", "chest", "neck", "head")
PARTS = (*LIMBS, *TRUNK)
TRIVIAL = 15  # frames around the diagonal where a motion goes on into itself


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
    """One labelled transition left out: how far the best transition point moved without it."""

    row: int
    best: Point
    without: Point

    @property
    def moved(self) -> int:
        """Frames by which the point moved, the larger of both motions' moves."""
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
) -> tuple[list[Left], list[Left]]:
    """How far the best transition point moves when one labelled transition is left out (IV.3).

    The first list judges on the motions of the transition left out, the second on `other`, a
    motion (or pair) of another performer; empty without one.
    """
    differences, labels = design_matrix(transitions, parts, velocity_weight)
    whole = fit_weights(differences, labels, parts)
    own: list[Left] = []
    foreign: list[Left] = []
    known: dict[tuple[int, int], tuple[Array, Array]] = {}

    def best(a: Motion, b: Motion, weights: Array) -> Point:
        key = (id(a), id(b))
        if key not in known:
            known.clear()  # one pair's matrices at a time
            known[key] = (part_distances(a, b, parts, velocity_weight),
                          root_cost(a, b, velocity_weight))  # fmt: skip
        distances, root = known[key]
        cost = root + np.tensordot(weights, distances, axes=1)
        found = cheapest(cost, trivial=TRIVIAL if a is b else -1)
        if found is None:
            raise InputError("weights: expected motions longer than half a second, found shorter.")
        return found

    fits = []
    for row in range(len(transitions)):
        kept = np.arange(len(transitions)) != row
        fits.append(fit_weights(differences[kept], labels[kept], parts).weights)
    for row, (t, weights) in enumerate(zip(transitions, fits, strict=True)):
        own.append(Left(row, best(t.a, t.b, whole.weights), best(t.a, t.b, weights)))
        if progress:
            progress(row + 1)
    if other is not None:
        foreign = [
            Left(row, best(*other, whole.weights), best(*other, weights))
            for row, weights in enumerate(fits)
        ]
    return own, foreign


def _roles(part: str) -> tuple[str, ...]:
    return tuple(f"{side}_{part}" for side in SIDES) if part in LIMBS else (part,)


def summary(left: Sequence[Left]) -> Mapping[str, float | int]:
    """Mean and median of the frames moved, and how many points did not move."""
    moved = np.array([entry.moved for entry in left])
    return {
        "count": len(moved),
        "unmoved": int(np.count_nonzero(moved == 0)),
        "mean": float(moved.mean()),
        "median": float(np.median(moved)),
    }
