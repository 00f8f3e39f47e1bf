"""A scale of three or more methods from who was preferred to whom (Bradley and Terry 1952).

The log odds that i is preferred to j are the difference of their strengths, which sum to zero.
Intervals resample people, since one person's answers are alike.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from analysis.psychometric.bootstrap import percentile_interval
from analysis.psychometric.functions import Array

SCALE_SAMPLES = 1000
_ITERATIONS = 60


@dataclass(frozen=True)
class Strength:
    """A method's place on the scale, in log odds; the ends are None when a bound is infinite."""

    method: str
    strength: float
    low: float | None
    high: float | None


def bradley_terry(wins: Array) -> Array:
    """Strengths (..., K) from counts (..., K, K) of row preferred to column, by Newton's method.

    nan where no finite maximum exists: some method, or group of them, never lost to or never won
    against the rest (Ford 1957).
    """
    wins = np.asarray(wins, float)
    games = wins + wins.swapaxes(-1, -2)
    size = wins.shape[-1]
    strength = np.zeros(wins.shape[:-1])
    for _ in range(_ITERATIONS):
        difference = strength[..., :, None] - strength[..., None, :]
        p = 1 / (1 + np.exp(-difference))
        gradient = (wins - games * p).sum(-1)
        weight = games * p * (1 - p)
        information = -weight + np.eye(size) * weight.sum(-1)[..., None]
        # The strengths are fixed by their sum: a constant added makes the matrix invertible.
        step = np.linalg.solve(information + 1 / size + 1e-10 * np.eye(size), gradient[..., None])
        strength = strength + np.clip(step[..., 0], -2, 2)
    strength = strength - strength.mean(-1, keepdims=True)
    return np.where(_connected(wins)[..., None], strength, np.nan)


def _connected(wins: Array) -> Array:
    """Whether every method reached every other by a chain of wins."""
    size = wins.shape[-1]
    reached = (wins > 0) | np.eye(size, dtype=bool)
    for _ in range(size.bit_length()):
        reached = (reached.astype(float) @ reached.astype(float)) > 0
    return reached.all((-1, -2))


def scale(
    trials: pd.DataFrame, methods: tuple[str, ...], rng: np.random.Generator
) -> list[Strength] | None:
    """Strengths of answered trials, strongest first; None where they are not identifiable."""
    people, person = np.unique(trials["participant"].astype(str), return_inverse=True)
    place = {method: number for number, method in enumerate(methods)}
    first = trials["first_method"].map(place).to_numpy(int)
    second = trials["second_method"].map(place).to_numpy(int)
    won_first = (trials["chosen_method"] == trials["first_method"]).to_numpy()
    winner, loser = np.where(won_first, first, second), np.where(won_first, second, first)
    wins = np.zeros((len(people), len(methods), len(methods)))
    np.add.at(wins, (person, winner, loser), 1.0)
    strengths = bradley_terry(wins.sum(0))
    if np.isnan(strengths).any():
        return None
    drawn = rng.multinomial(len(people), np.full(len(people), 1 / len(people)), SCALE_SAMPLES)
    again = bradley_terry(np.einsum("bp,pij->bij", drawn.astype(float), wins))
    shaky = np.isnan(again).any(1).mean() > 0.025
    found = []
    for number, method in enumerate(methods):
        low, high = percentile_interval(again[:, number])
        ends = (None, None) if shaky else (low, high)
        found.append(Strength(method, float(strengths[number]), *ends))
    return sorted(found, key=lambda entry: -entry.strength)
