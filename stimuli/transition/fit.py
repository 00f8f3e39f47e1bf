"""Weights of the pose cost from labelled transitions (Wang 2005, IV.2 and IV.3)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stimuli.errors import InputError
from stimuli.motion.quaternions import Array
from stimuli.motion.roles import LIMBS
from stimuli.motion.skeleton import Motion
from stimuli.ties import ROUNDING
from stimuli.transition.distance import check_pair, joint_rotations, joint_velocities, root_cost
from stimuli.transition.points import TRIVIAL, TransitionPoint, cheapest
from stimuli.transition.weights import SIDES, Weights, tied

TRUNK = ("pelvis", "spine", "chest", "neck", "head")
PARTS = (*LIMBS, *TRUNK)
CELLS = 8_000_000  # of all parts' distances at once, 64 MB: whole matrices of long clips need GB


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
class LeftOut:
    """One labelled transition left out: how far the best transition point moved without it.

    `without` is None where it cannot be left out, and `reason` says why. `periods` are those of
    the motions, in frames, None where one is no loop.
    """

    row: int
    best: TransitionPoint
    without: TransitionPoint | None
    reason: str = ""
    periods: tuple[float | None, float | None] = (None, None)

    @property
    def moved(self) -> int | None:
        """Frames by which the point moved, the larger of both motions' moves, round a loop."""
        if self.without is None:
            return None
        first, second = self.periods
        return max(
            _apart(self.best.i, self.without.i, first), _apart(self.best.j, self.without.j, second)
        )


def _apart(one: int, other: int, period: float | None) -> int:
    """Frames between two frames, the shorter way round where the motion is a loop."""
    apart = abs(one - other)
    return apart if period is None else round(abs(apart - period * round(apart / period)))


def common_parts(motions: Sequence[Motion]) -> tuple[str, ...]:
    """Parts whose joints (both sides) every motion knows, each joint under one name."""
    known: list[str] = []
    for part in PARTS:
        if all(set(_roles(part)) <= set(m.skeleton.roles) for m in motions) and not any(
            _joints(m, part) & _joints(m, other) for m in motions for other in known
        ):
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
) -> tuple[list[LeftOut], list[LeftOut]]:
    """How far the best transition point moves when one labelled transition is left out (IV.3).

    The first list judges on the motions of the transition left out, the second on `other`, a
    motion (or pair) of another performer; empty without one. The best point has `before` frames
    before i and `after` behind j; InputError where a pair of motions has none such.
    """
    differences, labels = design_matrix(transitions, parts, velocity_weight)
    whole = fit_weights(differences, labels, parts).weights
    rows = range(len(transitions))
    fits = [_fit_without(row, differences, labels, parts) for row in rows]

    def judged(
        a: Motion, b: Motion, asked: Sequence[int], tell: Callable[[float], None]
    ) -> list[LeftOut]:
        """The rows asked for, judged on one pair of motions; `tell` takes the share done."""
        sets = [whole, *(weights for row in asked if (weights := fits[row][0]) is not None)]
        found = _best_points(a, b, np.array(sets), parts, velocity_weight, before, after, tell)
        best, *others = found
        without = iter(others)
        periods = (_period(a), _period(b))
        return [
            LeftOut(
                row, best, None if fits[row][0] is None else next(without), fits[row][1], periods
            )
            for row in asked
        ]

    pairs: dict[tuple[int, int], list[int]] = {}
    for row, t in enumerate(transitions):
        pairs.setdefault((id(t.a), id(t.b)), []).append(row)
    own: dict[int, LeftOut] = {}
    for asked in pairs.values():
        first, tell = transitions[asked[0]], _shares(progress, len(own), len(asked))
        own |= {left.row: left for left in judged(first.a, first.b, asked, tell)}
    foreign = judged(*other, rows, lambda share: None) if other else []
    return [own[row] for row in rows], foreign


def _shares(
    progress: Callable[[int], None] | None, done: int, more: int
) -> Callable[[float], None]:
    """Tells `progress` of shares of `more` rows beyond those that are done."""
    return lambda share: progress(done + round(share * more)) if progress else None


def _best_points(
    a: Motion,
    b: Motion,
    sets: Array,
    parts: Sequence[str],
    velocity_weight: float,
    before: int,
    after: int,
    tell: Callable[[float], None],
) -> list[TransitionPoint]:
    """The cheapest cell under each set of weights (K, P), the first of equals.

    Block by block of frames of `a`; one frame more on either side gives the velocities.
    """
    best: list[TransitionPoint | None] = [None] * len(sets)
    trivial = TRIVIAL if a.same_as(b) else -1
    size = max(1, CELLS // (len(parts) * len(b)))
    for first in range(0, len(a), size):
        last, start = min(first + size, len(a)), max(first - 1, 0)
        near, kept = a[start : last + 1], slice(first - start, last - start)
        distances = part_distances(near, b, parts, velocity_weight)[:, kept]
        root = root_cost(near, b, velocity_weight)[kept]
        frames = np.arange(first, last)[:, None]
        root[np.abs(frames - np.arange(len(b))) <= trivial] = np.inf
        for row, weights in enumerate(sets):
            cost = root + np.tensordot(weights, distances, axes=1)
            found, held = cheapest(cost, before - first, after), best[row]
            if found is not None and (held is None or found.cost < held.cost - ROUNDING):
                best[row] = TransitionPoint(found.i + first, found.j, found.cost)
        tell(last / len(a))
    found_all = [point for point in best if point is not None]
    if len(found_all) < len(best):
        raise InputError(
            f"weights: expected a transition point with {before} frames before it and {after} "
            f"after it, found none in motions of {len(a)} and {len(b)} frames."
        )
    return found_all


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


def _period(motion: Motion) -> float | None:
    return None if motion.cycle is None else motion.cycle.period


def _joints(motion: Motion, part: str) -> set[int]:
    return {motion.skeleton.roles[role] for role in _roles(part)}


def summary(left: Sequence[LeftOut]) -> Mapping[str, float | int | None]:
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
