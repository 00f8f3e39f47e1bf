"""Resampled counts: from the fitted function, from the trials, from people and their trials."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from analysis.psychometric.counts import Counts, counts, merged
from analysis.psychometric.fit import Batch
from analysis.psychometric.functions import Array

Resamples = tuple[Array, Array]  # correct and total, (B, L)


@dataclass(frozen=True, eq=False)
class PeopleCounts:
    """Counts of P people at common levels (L,): `correct` and `total` are (P, L)."""

    levels: Array
    correct: Array
    total: Array
    people: tuple[str, ...]

    def of(self, row: int) -> "PeopleCounts":
        """One person alone, at the levels that they saw."""
        seen = self.total[row] > 0
        return PeopleCounts(
            self.levels[seen],
            self.correct[row : row + 1, seen],
            self.total[row : row + 1, seen],
            self.people[row : row + 1],
        )

    def pooled(self) -> Counts:
        return Counts(self.levels, self.correct.sum(0), self.total.sum(0))


def people_counts(people: ArrayLike, levels: ArrayLike, correct: ArrayLike) -> PeopleCounts:
    """Single trials (N,) gathered by person and level."""
    pooled = counts(levels, correct)
    names, person = np.unique(np.asarray(people).astype(str), return_inverse=True)
    place = merged(np.asarray(levels, float))[1]
    shape = (len(names), len(pooled.levels))
    cell = person * shape[1] + place
    total = np.bincount(cell, minlength=shape[0] * shape[1]).reshape(shape).astype(float)
    right = np.bincount(cell, np.asarray(correct, float), shape[0] * shape[1]).reshape(shape)
    return PeopleCounts(pooled.levels, right, total, tuple(str(name) for name in names))


def resample_parametric(
    fits: Batch, total: Array, samples: int, rng: np.random.Generator
) -> Resamples:
    """Draws (B·samples, L) from B fits, as many trials at each level as `total` (B, L) says."""
    shape = fits.setting.function
    span = 1 - fits.setting.guess - fits.lapse[:, None]
    p = fits.setting.guess + span * shape.cdf(fits.a[:, None] + fits.b[:, None] * fits.scale.z)
    n = np.repeat(total.astype(int), samples, axis=0)
    drawn = rng.binomial(n, np.repeat(np.clip(p, 0, 1), samples, axis=0))
    return drawn.astype(float), n.astype(float)


def resample_trials(data: Counts, samples: int, rng: np.random.Generator) -> Resamples:
    """Trials drawn with replacement within each level."""
    n = data.total.astype(int)
    drawn = rng.binomial(n, data.correct / data.total, (samples, len(n)))
    return drawn.astype(float), np.broadcast_to(data.total, drawn.shape).copy()


def resample_people(data: PeopleCounts, samples: int, rng: np.random.Generator) -> Resamples:
    """People drawn with replacement, then trials with replacement within each person drawn.

    People are ordered by their counts, so that draws do not go by what they are called.
    """
    persons = len(data.people)
    cells = np.concatenate([data.correct, data.total - data.correct], 1)
    cells = cells[np.lexsort(cells.T)]
    n = cells.sum(1)
    drawn = rng.integers(persons, size=(samples, persons))
    shares = cells / np.maximum(n, 1)[:, None]
    again = rng.multinomial(n.astype(int)[drawn], shares[drawn]).sum(1).astype(float)
    right, wrong = np.split(again, 2, axis=1)
    return right, right + wrong


def percentile_interval(values: Array, level: float = 0.95) -> tuple[float, float]:
    """Central interval of bootstrap values, which may hold ±inf; undefined ones are left out."""
    kept = values[~np.isnan(values)]
    if len(kept) == 0:
        return float("-inf"), float("inf")
    tails = [(1 - level) / 2, (1 + level) / 2]
    low, high = np.quantile(kept, tails, method="inverted_cdf")
    return float(low), float(high)
