"""Beside the plain fit of a side: other fits of the same trials, and what moves with it.

The bias-reduced fit, the fit of all people at once with a random threshold, thresholds in d′, the
Weber fraction, another tool's opinion, fits against what was shown, and whether motions, sides
and specifications share one function.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import pandas as pd

from analysis.naturalness import clip_measures
from analysis.psychometric import Counts, Setting, counts, fit, people_counts, summarise
from analysis.psychometric.compare import Comparison, same_function
from analysis.psychometric.dprime import DECISION_RULES, proportion_of
from analysis.psychometric.opinion import Opinion, second_opinion
from analysis.psychometric.random import RandomThreshold, fit_random_threshold
from analysis.psychometric.reduced import fit_reduced
from analysis.psychometric.summary import Threshold, threshold_dict
from analysis.thresholds import ALL, Entry, FitPlan

UNIT_D_PRIME = 1.0
RELATIVE = "_from_reference"
FEWEST_LEVELS = 3  # distinct values that a measure must take to be fitted


@dataclass(frozen=True)
class Supplement:
    """What stands beside one entry; signed like it."""

    side: str
    specification: str
    motion: str
    weber_fraction: float | None
    bias_reduced: dict[str, float] | None
    random_threshold: dict[str, Any] | None
    second_opinion: dict[str, Any] | None
    d_prime: tuple[dict[str, Any], ...]

    def as_dict(self) -> dict[str, Any]:
        return {
            "weber_fraction": self.weber_fraction,
            "bias_reduced": self.bias_reduced,
            "random_threshold": self.random_threshold,
            "second_opinion": self.second_opinion,
            "d_prime": list(self.d_prime),
        }


def supplement(entry: Entry, trials: pd.DataFrame, plan: FitPlan, opinion: bool) -> Supplement:
    """The other fits of a pooled entry; nothing is fitted where the verdict denies a threshold."""
    at, sign = plan.at[0], entry.sign
    ok = entry.summary.verdict == "ok"
    whole = ok and entry.motion == ALL
    reference = _reference(trials, entry)
    value = entry.summary.thresholds[0].value
    reduced = fit_reduced(entry.counts, plan.what) if ok else None
    found = fit_random_threshold(entry.data, plan.what, at) if whole and _several(entry) else None
    told = second_opinion(entry.counts, plan.what, at) if ok and opinion else None
    return Supplement(
        side=entry.side,
        specification=entry.specification,
        motion=entry.motion,
        weber_fraction=sign * value / reference if ok and reference else None,
        bias_reduced=None
        if reduced is None
        else {"value": sign * reduced.threshold(at), "slope": reduced.slope},
        random_threshold=None if found is None else _within(entry, found),
        second_opinion=None if told is None else _within(entry, told),
        d_prime=_in_d_prime(entry, plan) if whole else (),
    )


def _several(entry: Entry) -> bool:
    return len(entry.data.people) > 1


def _reference(trials: pd.DataFrame, entry: Entry) -> float | None:
    """The mean reference length of an entry's trials, where it is recorded."""
    if "reference_length" not in trials:
        return None
    own = trials[(trials["track"] == entry.side) & (trials["specification"] == entry.specification)]
    if entry.motion != ALL:
        own = own[own["motion"] == entry.motion]
    mean = float(own["reference_length"].mean())
    return mean if np.isfinite(mean) and mean > 0 else None


def _within(entry: Entry, found: RandomThreshold | Opinion) -> dict[str, Any]:
    """Another fit's numbers, signed like the entry, ends beyond the levels shown as reasons."""
    plain = entry.summary.thresholds[0]
    own = Threshold(plain.at, found.value, found.low, found.high, plain.least, plain.most)
    told = threshold_dict(own if entry.sign > 0 else own.signed_down, "ok", signed=True)
    return asdict(found) | {name: held for name, held in told.items() if name != "at"}


def _in_d_prime(entry: Entry, plan: FitPlan) -> tuple[dict[str, Any], ...]:
    """Thresholds at d′ = 1 under each decision rule, with profile intervals."""
    ats = tuple(proportion_of(UNIT_D_PRIME, rule) for rule in DECISION_RULES)
    fitted = summarise(entry.counts, plan.what, ats, samples=0)
    rows = []
    for rule, threshold, verdict in zip(
        DECISION_RULES, fitted.thresholds, fitted.verdicts, strict=True
    ):
        told = threshold_dict(
            threshold if entry.sign > 0 else threshold.signed_down, verdict, signed=True
        )
        rows.append({"rule": rule, "d_prime": UNIT_D_PRIME, **told, "verdict": verdict})
    return tuple(rows)


@dataclass(frozen=True)
class Difference:
    """A likelihood-ratio test that some sets of trials share one function."""

    between: str
    side: str
    specification: str
    groups: tuple[str, ...]
    test: Comparison

    def as_dict(self) -> dict[str, Any]:
        return {
            "between": self.between,
            "side": self.side,
            "specification": self.specification,
            "groups": list(self.groups),
            **asdict(self.test),
        }


# What is compared: the column that splits the trials, and the columns that are kept apart.
SPLITS = {
    "motions": ("motion", ["specification", "track"]),
    "sides": ("track", ["specification"]),
    "specifications": ("specification", ["track"]),
}


def differences(
    trials: pd.DataFrame, what: Setting, splits: tuple[str, ...] = tuple(SPLITS)
) -> list[Difference]:
    """Tests between motions (each side apart), sides, and specifications (each side apart)."""
    found = []
    for between in splits:
        column, apart = SPLITS[between]
        for key, part in trials.groupby(apart, sort=True):
            groups = {str(name): _counts(own) for name, own in part.groupby(column, sort=True)}
            if len(groups) > 1:
                place = dict(zip(apart, key, strict=True))
                found.append(
                    Difference(
                        between,
                        str(place.get("track", ALL)),
                        str(place.get("specification", ALL)),
                        tuple(groups),
                        same_function(list(groups.values()), what),
                    )
                )
    return found


def _counts(trials: pd.DataFrame) -> Counts:
    return counts(trials["level"], trials["correct"])


@dataclass(frozen=True)
class Shown:
    """A fit against a measure of the clips instead of their nominal length."""

    measure: str
    side: str
    levels: int
    threshold: dict[str, float | None]
    verdict: str
    gain: float  # log likelihood above that of the fit to nominal length, on the same trials


def against_shown(
    trials: pd.DataFrame, stimuli: Mapping[str, dict[str, Any]], plan: FitPlan
) -> list[Shown]:
    """Fits of each side against |measure of the odd clip − measure of the reference|."""
    if not {"clip_a", "clip_b"} <= set(trials):
        return []
    known = {clip: clip_measures(entry) for clip, entry in stimuli.items()}
    names = sorted({name for entry in known.values() for name in entry})
    found = []
    for name in names:
        ends = [
            trials[clip].map(lambda hash_, name=name: known.get(hash_, {}).get(name, np.nan))
            for clip in ("clip_a", "clip_b")
        ]
        # A measure that is itself a difference from the reference needs no second subtraction.
        level = ends[1] if name.endswith(RELATIVE) else ends[1] - ends[0]
        level = level.astype(float).abs()
        for side, part in trials.groupby("track", sort=True):
            own = level[part.index]
            kept = own.notna() & (own > 0)
            if own[kept].nunique() < FEWEST_LEVELS:
                continue
            told = _fit_shown(part[kept], own[kept], plan)
            found.append(Shown(name, str(side), int(own[kept].nunique()), *told))
    return found


def _fit_shown(
    part: pd.DataFrame, level: pd.Series, plan: FitPlan
) -> tuple[dict[str, float | None], str, float]:
    data = people_counts(part["participant"], level, part["correct"]).pooled()
    summary = summarise(data, plan.what, plan.at[:1], samples=0)
    nominal = float(fit(_counts(part), plan.what).value[0])
    told = summary.as_dict()
    return told["threshold"], summary.verdict, summary.log_likelihood - nominal
