"""Strengths of methods where people may answer that two are equal (Davidson 1970).

With strengths s and θ the log of Davidson's ν, the odds of “i”, “j” and “equal” between i and j
are e^s_i : e^s_j : e^(θ + (s_i + s_j)/2). The likelihood is that of a log-linear model and concave;
without ties it is Bradley and Terry's. Intervals resample people, as theirs do.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
import pandas as pd

from analysis.bradley_terry import SCALE_SAMPLES, Strength, bradley_terry
from analysis.psychometric.bootstrap import percentile_interval
from analysis.psychometric.functions import Array

_ITERATIONS = 60
UNSURE = 0.025  # share of resamples without a finite maximum above which no interval is given


@dataclass(frozen=True)
class TiedScale:
    """Strengths, strongest first, and the log odds θ of a tie between equals with its interval."""

    strengths: tuple[Strength, ...]
    tie: float
    low: float | None
    high: float | None
    ties: int


def davidson(wins: Array, ties: Array) -> tuple[Array, Array]:
    """Strengths (..., K), which sum to 0, and θ (...,), by Newton's method.

    `wins` (..., K, K) counts row preferred to column, `ties` (..., K, K) is symmetric. nan where
    no finite maximum exists: a method that never lost, nor was ever tied, is not on the scale.
    """
    wins, ties = np.asarray(wins, float), np.asarray(ties, float)
    size = wins.shape[-1]
    pairs = list(combinations(range(size), 2))
    parameters = np.zeros((*wins.shape[:-2], size + 1))
    sums = np.zeros((size + 1, size + 1))
    sums[:size, :size] = 1 / size  # the strengths are fixed by their sum
    for _ in range(_ITERATIONS):
        gradient = np.zeros(parameters.shape)
        information = np.zeros((*parameters.shape, size + 1))
        for i, j in pairs:
            design = _design(i, j, size)
            observed = np.stack([wins[..., i, j], wins[..., j, i], ties[..., i, j]], -1)
            games = observed.sum(-1, keepdims=True)
            eta = parameters @ design.T
            p = np.exp(eta - eta.max(-1, keepdims=True))
            p = p / p.sum(-1, keepdims=True)
            gradient += (observed - games * p) @ design
            mean = p @ design
            spread = np.einsum("...k,ka,kb->...ab", p, design, design)
            spread = spread - mean[..., :, None] * mean[..., None, :]
            information += games[..., None] * spread
        step = np.linalg.solve(information + sums + 1e-10 * np.eye(size + 1), gradient[..., None])
        parameters = parameters + np.clip(step[..., 0], -2, 2)
    strength = parameters[..., :size]
    finite = ~np.isnan(bradley_terry(wins + ties / 2)).any(-1) & (ties.sum((-1, -2)) > 0)
    finite &= np.abs(parameters).max(-1) < 15
    centred = strength - strength.mean(-1, keepdims=True)
    return (
        np.where(finite[..., None], centred, np.nan),
        np.where(finite, parameters[..., size], np.nan),
    )


def _design(i: int, j: int, size: int) -> Array:
    """What each answer (i, j, equal) has of each parameter: (3, K + 1)."""
    design = np.zeros((3, size + 1))
    design[0, i] = design[1, j] = 1.0
    design[2, [i, j]], design[2, size] = 0.5, 1.0
    return design


def tied_scale(
    trials: pd.DataFrame, methods: tuple[str, ...], rng: np.random.Generator
) -> TiedScale | None:
    """The scale of answered trials with ties; None without ties or where it has no bound."""
    people, person = np.unique(trials["participant"].astype(str), return_inverse=True)
    place = {method: number for number, method in enumerate(methods)}
    first = trials["first_method"].map(place).to_numpy(int)
    second = trials["second_method"].map(place).to_numpy(int)
    tied = trials["tie"].to_numpy(bool)
    won_first = (trials["chosen_method"] == trials["first_method"]).to_numpy() & ~tied
    won_second = ~won_first & ~tied
    shape = (len(people), len(methods), len(methods))
    wins, ties = np.zeros(shape), np.zeros(shape)
    np.add.at(wins, (person[won_first], first[won_first], second[won_first]), 1.0)
    np.add.at(wins, (person[won_second], second[won_second], first[won_second]), 1.0)
    np.add.at(ties, (person[tied], first[tied], second[tied]), 1.0)
    ties = ties + ties.swapaxes(1, 2)
    strengths, tie = davidson(wins.sum(0), ties.sum(0))
    if np.isnan(strengths).any():
        return None
    drawn = rng.multinomial(len(people), np.full(len(people), 1 / len(people)), SCALE_SAMPLES)
    again, tie_again = davidson(
        *(np.einsum("bp,pij->bij", drawn.astype(float), counts) for counts in (wins, ties))
    )
    sure = len(people) > 1 and np.isnan(again).any(1).mean() <= UNSURE
    ends = [percentile_interval(again[:, n]) if sure else (None, None) for n in range(len(methods))]
    found = [Strength(method, float(strengths[n]), *ends[n]) for n, method in enumerate(methods)]
    low, high = percentile_interval(tie_again) if sure else (None, None)
    ranked = tuple(sorted(found, key=lambda entry: -entry.strength))
    return TiedScale(ranked, float(tie), low, high, int(tied.sum()))
