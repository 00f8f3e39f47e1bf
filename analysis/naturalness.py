"""Scores against labels: does a number computed from a clip tell natural from unnatural?

The receiver operating curve of a score against the answers of the `natural` task, its area with
an interval that resamples people and clips (answers share both), and the agreement of people.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import norm, rankdata

from analysis.psychometric.bootstrap import percentile_interval
from analysis.psychometric.functions import Array

_SAMPLES = 2000
_INTERVAL = 0.95


@dataclass(frozen=True, eq=False)
class Labels:
    """How often each person (P) called each clip (C) unnatural and natural: (P, C) counts."""

    people: tuple[str, ...]
    clips: tuple[str, ...]
    unnatural: Array
    natural: Array


@dataclass(frozen=True, eq=False)
class ReceiverCurve:
    """A receiver operating curve: false alarms and hits by falling score, and its area."""

    score: str
    false_alarms: Array
    hits: Array
    area: float
    low: float
    high: float
    answers: int


@dataclass(frozen=True)
class AreaDifference:
    """By how much the area of one score is larger than another's on the same clips, and its test.

    `difference`, its 95 % interval, z and p are those of DeLong, DeLong and Clarke-Pearson (1988).
    """

    first: str
    second: str
    areas: tuple[float, float]
    difference: float
    low: float
    high: float
    z: float
    p: float
    clips: int


def labels(trials: pd.DataFrame) -> Labels:
    """Answered trials of the `natural` task as counts."""
    people, person = np.unique(trials["participant"].astype(str), return_inverse=True)
    clips, clip = np.unique(trials["clip"].astype(str), return_inverse=True)
    natural = (trials["response"] == "natural").to_numpy()
    shape = (len(people), len(clips))
    counts = []
    for kept in (~natural, natural):
        table = np.zeros(shape)
        np.add.at(table, (person[kept], clip[kept]), 1.0)
        counts.append(table)
    return Labels(tuple(map(str, people)), tuple(map(str, clips)), *counts)


def receiver_curve(
    name: str, scores: Array, answers: Labels, rng: np.random.Generator, samples: int = _SAMPLES
) -> ReceiverCurve | None:
    """The curve of `scores` (C,), higher meaning less natural; None when one answer is absent.

    The area is the probability that an answer “unnatural” fell on a clip of higher score than an
    answer “natural”, ties counted half (Hanley and McNeil 1982).
    """
    known = np.isfinite(scores)
    scores = scores[known]
    unnatural, natural = answers.unnatural[:, known], answers.natural[:, known]
    u, n = unnatural.sum(0), natural.sum(0)
    if u.sum() == 0 or n.sum() == 0:
        return None
    falling = np.argsort(-scores, kind="stable")
    ends = np.append(np.flatnonzero(np.diff(scores[falling])), len(scores) - 1)
    hits = np.append(0, np.cumsum(u[falling])[ends] / u.sum())
    alarms = np.append(0, np.cumsum(n[falling])[ends] / n.sum())
    above = (np.sign(scores[:, None] - scores[None, :]) + 1) / 2
    draws = _resampled(unnatural, natural, above, rng, samples)
    low, high = percentile_interval(draws)
    area = float(u @ above @ n / (u.sum() * n.sum()))
    return ReceiverCurve(name, alarms, hits, area, low, high, int(u.sum() + n.sum()))


def _resampled(
    unnatural: Array, natural: Array, above: Array, rng: np.random.Generator, samples: int
) -> Array:
    """Areas of sets in which people and clips are drawn with replacement (Owen 2007)."""
    people, clips = unnatural.shape
    who = rng.multinomial(people, np.full(people, 1 / people), samples).astype(float)
    which = rng.multinomial(clips, np.full(clips, 1 / clips), samples).astype(float)
    u, n = (who @ unnatural) * which, (who @ natural) * which
    with np.errstate(invalid="ignore"):
        return ((u @ above) * n).sum(1) / (u.sum(1) * n.sum(1))


def called_unnatural(answers: Labels) -> Array:
    """What most people call each clip (C,): 1 unnatural, 0 natural, NaN where halves disagree."""
    for_it, against = answers.unnatural.sum(0), answers.natural.sum(0)
    return np.where(for_it == against, np.nan, (for_it > against).astype(float))


def delong(
    scores: dict[str, Array], first: str, second: str, unnatural: Array
) -> AreaDifference | None:
    """Whether two `scores` (C,) of the same clips differ in area; None without both kinds of clip.

    A clip is one case, called as most people call it (`unnatural`, (C,) of 1, 0 and NaN); clips
    without a call or either score are left out. Components by midranks (Sun and Xu 2014).
    """
    both = np.stack([scores[first], scores[second]])
    known = np.isfinite(both).all(axis=0) & np.isfinite(unnatural)
    both, bad = both[:, known], unnatural[known] == 1
    m, n = int(bad.sum()), int((~bad).sum())
    if min(m, n) < 2:
        return None
    among_all, of_bad, of_good = (
        np.array([rankdata(row) for row in part]) for part in (both, both[:, bad], both[:, ~bad])
    )
    hit = (among_all[:, bad] - of_bad) / n
    spared = 1 - (among_all[:, ~bad] - of_good) / m
    areas = hit.mean(axis=1)
    spread = np.cov(hit) / m + np.cov(spared) / n
    difference = float(areas[0] - areas[1])
    error = float(np.sqrt(max(spread[0, 0] + spread[1, 1] - 2 * spread[0, 1], 0.0)))
    z = difference / error if error > 0 else 0.0
    reach = float(norm.ppf(0.5 + _INTERVAL / 2)) * error
    return AreaDifference(
        first, second, (float(areas[0]), float(areas[1])), difference,
        difference - reach, difference + reach, z, float(2 * norm.sf(abs(z))), m + n,
    )  # fmt: skip


def krippendorff_alpha(ratings: Array) -> float | None:
    """Krippendorff's α of nominal ratings (raters, units), nan where missing; None if undefined.

    1 is perfect agreement, 0 that of chance (Krippendorff 2011).
    """
    values = np.unique(ratings[~np.isnan(ratings)])
    tally = np.stack([(ratings == value).sum(0) for value in values], 1).astype(float)
    tally = tally[tally.sum(1) >= 2]
    if len(tally) == 0 or len(values) < 2:
        return None
    pairs = tally.sum(1) - 1
    observed = ((tally * (tally.sum(1, keepdims=True) - tally)).sum(1) / pairs).sum()
    totals = tally.sum(0)
    whole = totals.sum()
    expected = (whole**2 - (totals**2).sum()) / (whole - 1)
    return float(1 - observed / expected) if expected > 0 else None


def agreement(answers: Labels) -> dict[str, Any]:
    """Krippendorff's α and the share of pairs of people that agree on a clip."""
    with np.errstate(invalid="ignore"):
        share = answers.unnatural / (answers.unnatural + answers.natural)
    ratings = np.where(np.isnan(share), np.nan, np.round(share))
    yes, no = (ratings == 1).sum(0), (ratings == 0).sum(0)
    pairs = (yes + no) * (yes + no - 1) / 2
    alike = yes * (yes - 1) / 2 + no * (no - 1) / 2
    return {
        "krippendorff_alpha": krippendorff_alpha(ratings),
        "pairwise": float(alike.sum() / pairs.sum()) if pairs.sum() else None,
    }


def scores_of(clips: tuple[str, ...], stimuli: dict[str, dict[str, Any]]) -> dict[str, Array]:
    """Every number among the manifest's measures of the clips, by its dotted name: (C,)."""
    flat = [clip_measures(stimuli.get(clip, {})) for clip in clips]
    names = sorted({name for entry in flat for name in entry})
    return {name: np.array([entry.get(name, np.nan) for entry in flat]) for name in names}


def clip_measures(entry: dict[str, Any]) -> dict[str, float]:
    """The numbers among an entry's `measures`, tables within it flattened to dotted names."""
    found: dict[str, float] = {}
    waiting = [("", entry.get("measures"))]
    while waiting:
        prefix, value = waiting.pop()
        if isinstance(value, dict):
            waiting += [(f"{prefix}.{key}" if prefix else str(key), v) for key, v in value.items()]
        elif isinstance(value, int | float) and not isinstance(value, bool) and prefix:
            found[prefix] = float(value)
    return found
