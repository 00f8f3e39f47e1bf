"""The exact behaviour of a staircase on a known observer: a finite Markov chain.

The chain's states are (level, state of the rule, direction of the last move); its stationary
distribution says where a track that never stops spends its trials, so the proportion that a rule
targets needs no simulation.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from study.trials.staircase import Rule


@dataclass(frozen=True)
class Stationary:
    """The long run of a staircase: occupancy of levels (L,), its mean, the mean level at which it
    turns (None where it never does), and the proportion right."""

    occupancy: NDArray[np.float64]
    mean_level: float
    mean_reversal: float | None
    overall_correct: float


def stationary(rule: Rule, levels: NDArray[np.float64], correct: NDArray[np.float64]) -> Stationary:
    """Stationary distribution of `rule` over ascending `levels` (L,).

    `correct` (L,) is the proportion right at each level. Only rules with whole steps have a finite
    chain; others raise ValueError.
    """
    if not rule.finite:
        raise ValueError("expected a rule with a finite chain, found one without")
    places = tuple(range(len(levels)))
    states = [
        (state, last) for state in reachable(rule, rule.begin(places, 0)) for last in (-1, 0, 1)
    ]
    index = {state: n for n, state in enumerate(states)}
    count, width = len(levels), len(states)
    matrix = np.zeros((count, width, count, width))
    turning = np.zeros((count, width))  # the chance to turn there
    here = np.arange(count)
    for (state, last), chances in product(states, ((True, correct), (False, 1 - correct))):
        right, chance = chances
        after, move = rule.step(state, right)
        target = np.clip(here + int(move), 0, count - 1)
        moved = np.sign(target - here)
        turning[:, index[state, last]] += chance * (moved * last < 0)
        for way in (-1, 0, 1):
            some = here[moved == way]
            place = index[after, way or last]
            matrix[some, index[state, last], target[some], place] += chance[some]
    held = _solve(matrix.reshape(count * width, -1)).reshape(count, width)
    occupancy = held.sum(axis=1)
    turns = (held * turning).sum(axis=1)
    return Stationary(
        occupancy,
        float(occupancy @ levels),
        float(turns @ levels / turns.sum()) if turns.sum() > 0 else None,
        float(occupancy @ correct),
    )


def reachable(rule: Rule, first: Any) -> Sequence[Any]:
    """All states of a rule that answers lead to from a first one, itself included."""
    found: dict[Any, None] = {first: None}
    frontier = [first]
    while frontier:
        state = frontier.pop()
        for right in (True, False):
            after, _ = rule.step(state, right)
            if after not in found:
                found[after] = None
                frontier.append(after)
    return list(found)


def _solve(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """The left eigenvector of a stochastic matrix for eigenvalue one, as a distribution.

    One balance equation follows from the others; the sum of one takes its place. Where no answer
    leads from some states to others, as on a track of one level, any such distribution will do.
    """
    system = matrix.T - np.eye(len(matrix))
    system[-1] = 1.0
    target = np.zeros(len(matrix))
    target[-1] = 1.0
    try:
        found = np.linalg.solve(system, target)
    except np.linalg.LinAlgError:
        found = np.linalg.lstsq(system, target, rcond=None)[0]
    solution = np.clip(found, 0.0, None)
    return solution / solution.sum()
