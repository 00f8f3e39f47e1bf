"""Staircase tracks: their levels in order, reversals and the estimates they end with."""

from collections import Counter
from dataclasses import dataclass

import numpy as np
import pandas as pd

from analysis.psychometric.functions import Array

FIRST_REVERSALS = 2  # left out of the mean where at least twice as many were run (Levitt 1971)


@dataclass(frozen=True, eq=False)
class AnsweredTrack:
    """One track: signed differences shown and whether each was answered right."""

    participant: str
    motion: str
    side: str
    specification: str
    differences: Array
    correct: Array

    @property
    def levels(self) -> Array:
        return np.abs(self.differences)


def tracks(trials: pd.DataFrame) -> list[AnsweredTrack]:
    """Answered trials in their order: a track for each person, motion, specification and side."""
    keys = ["participant", "motion", "specification", "track"]
    return [
        AnsweredTrack(str(person), str(motion), str(side), str(specification),
              part["difference"].to_numpy(float), part["correct"].to_numpy(float))
        for (person, motion, specification, side), part in trials.groupby(keys, sort=True)
    ]  # fmt: skip


def reversals(levels: Array) -> Array:
    """Indices of trials whose level was left in the direction opposite to how it was reached."""
    moves = np.flatnonzero(np.diff(levels))
    if len(moves) < 2:
        return np.array([], int)
    directions = np.sign(np.diff(levels)[moves])
    turned = np.flatnonzero(directions[1:] != directions[:-1]) + 1
    return moves[turned]


def reversal_mean(levels: Array) -> float | None:
    """Mean level at the reversals, the first few left out; None when there is none."""
    found = levels[reversals(levels)]
    if len(found) >= 2 * FIRST_REVERSALS:
        found = found[FIRST_REVERSALS:]
    return float(found.mean()) if len(found) else None


def stop_level(levels: Array) -> float | None:
    """The level answered most often; of several, the one that got there first.

    Under the visits rule (Wang VI.3) that is the level whose tenth answer ended the track.
    """
    visits: Counter[float] = Counter()
    leader: float | None = None
    for level in map(float, levels):
        visits[level] += 1
        if leader is None or visits[level] > visits[leader]:
            leader = level
    return leader


def staircase_threshold(found: list[AnsweredTrack]) -> dict[str, float | None]:
    """Signed means over tracks of both estimates: {stop_level, reversal_mean}."""
    told: dict[str, float | None] = {}
    for name, estimate in (("stop_level", stop_level), ("reversal_mean", reversal_mean)):
        values = [
            (value if track.side != "shorter" else -value)
            for track in found
            if (value := estimate(track.levels)) is not None
        ]
        told[name] = float(np.mean(values)) if values else None
    return told
