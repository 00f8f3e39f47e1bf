"""The exact behaviour of a staircase on a known observer: a finite Markov chain.

The chain's states are (level, state of the rule); its stationary distribution says where a track
that never stops spends its trials, so the proportion that a rule targets needs no simulation.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from study.trials.staircase import Rule


@dataclass(frozen=True)
class Stationary:
    """The long run of a staircase: occupancy of levels (L,), its mean, proportions right."""

    occupancy: NDArray[np.float64]
    mean_level: float
    overall_correct: float


def stationary(rule: Rule, levels: NDArray[np.float64], correct: NDArray[np.float64]) -> Stationary:
    """Stationary distribution of `rule` over ascending `levels` (L,).

    `correct` (L,) is the proportion right at each level. Only rules with whole steps have a finite
    chain; others raise ValueError.
    """
    states = _reachable(rule)
    index = {state: n for n, state in enumerate(states)}
    count, width = len(levels), len(states)
    matrix = np.zeros((count, width, count, width))
    places = np.arange(count)
    for state in states:
        for right, chance in ((True, correct), (False, 1 - correct)):
            after, move = rule.step(state, right)
            target = np.clip(places + int(move), 0, count - 1)
            matrix[places, index[state], target, index[after]] += chance
    occupancy = _solve(matrix.reshape(count * width, -1)).reshape(count, width).sum(axis=1)
    return Stationary(occupancy, float(occupancy @ levels), float(occupancy @ correct))


def _reachable(rule: Rule) -> Sequence[Any]:
    """All states of the rule that answers can lead to, the transient first one included."""
    found: dict[Any, None] = {rule.start: None}
    frontier = [rule.start]
    while frontier:
        state = frontier.pop()
        for right in (True, False):
            after, move = rule.step(state, right)
            if move != int(move):
                raise ValueError(f"expected whole steps for an exact chain, found {move}")
            if after not in found:
                found[after] = None
                frontier.append(after)
    return list(found)


def _solve(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """The left eigenvector of a stochastic matrix for eigenvalue one, as a distribution.

    One balance equation follows from the others; the sum of one takes its place.
    """
    system = matrix.T - np.eye(len(matrix))
    system[-1] = 1.0
    target = np.zeros(len(matrix))
    target[-1] = 1.0
    solution = np.clip(np.linalg.solve(system, target), 0.0, None)
    return solution / solution.sum()
