"""Psychometric fits of an odd-pair study: each side of the reference apart.

Pooled over people and motions, for each motion, and for each person; intervals of what is pooled
over people resample people and then trials within them, since trials of one person are alike.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from analysis.psychometric import (
    Counts,
    PeopleCounts,
    Setting,
    Summary,
    Threshold,
    people_counts,
    setting,
    summarise,
    summarise_each,
)
from analysis.psychometric.fit import LAPSE_BOUND
from analysis.psychometric.summary import threshold_dict
from analysis.tracks import AnsweredTrack, staircase_threshold, tracks

ALL = "all"
PERSON_SAMPLES = 200  # simulated deviances for one person's fit, of which there are many
_GUESS = 0.5  # two pairs to choose from


@dataclass(frozen=True)
class FitPlan:
    """How an odd-pair study is fitted, from the protocol's table [analysis]."""

    what: Setting
    at: tuple[float, ...] = (0.75, 0.70)
    samples: int = 2000
    seed: int = 0


def fit_plan_of(protocol: dict[str, Any], seed: int = 0) -> FitPlan:
    """The plan stated in a protocol; .75 (or the highest proportion named) leads."""
    stated = protocol.get("analysis")
    stated = stated if isinstance(stated, dict) else {}
    at = stated.get("at", (0.70, 0.75))
    named = [float(p) for p in (at if isinstance(at, list | tuple) else [at])]
    lapse = stated.get("lapse", "free")
    return FitPlan(
        what=setting(
            str(stated.get("function", "logistic")),
            _GUESS,
            None if lapse == "free" else lapse,
            float(stated.get("lapse_bound", LAPSE_BOUND)),
        ),
        at=tuple(sorted(named, key=lambda p: (p != 0.75, -p))),
        samples=int(stated.get("bootstrap", 2000)),
        seed=seed,
    )


@dataclass(frozen=True, eq=False)
class Entry:
    """One fit: where it belongs, its trials, its summary and the staircase's own estimates."""

    side: str
    specification: str
    motion: str
    participant: str
    data: PeopleCounts
    summary: Summary
    staircase: dict[str, float | None]

    @property
    def sign(self) -> float:
        return -1.0 if self.side == "shorter" else 1.0

    @property
    def counts(self) -> Counts:
        return self.data.pooled()

    def as_dict(self) -> dict[str, Any]:
        """The entry of report.json: thresholds signed and ordered, the fit on |difference|."""
        told = self.summary.as_dict()
        signed = [
            threshold_dict(signed_threshold(self, place), verdict, signed=True)
            for place, verdict in enumerate(self.summary.verdicts)
        ]
        return {
            "side": self.side,
            "specification": self.specification,
            "motion": self.motion,
            "participant": self.participant,
            "n": self.summary.trials,
            "function": self.summary.function,
            **told,
            "threshold": signed[0],
            "thresholds": signed,
            "staircase_threshold": self.staircase,
        }


def prepared(trials: pd.DataFrame, specification: str = "") -> pd.DataFrame:
    """Answered odd-pair trials with every column that the fits group by."""
    table = trials.copy()
    for column, default in (("motion", ""), ("specification", specification)):
        if column not in table:
            table[column] = default
        table[column] = table[column].fillna(default).astype(str)
    table["participant"] = table["participant"].astype(str)
    table["track"] = np.where(table["difference"] < 0, "shorter", "longer")
    table["level"] = table["difference"].abs()
    return table


def entries(trials: pd.DataFrame, plan: FitPlan) -> list[Entry]:
    """All fits of prepared trials: pooled, by motion, by person; shorter before longer."""
    found = []
    grouped = trials.groupby(["specification", "track"], sort=True)
    for (specification, side), part in sorted(
        grouped, key=lambda item: (item[0][0], item[0][1] != "shorter")
    ):
        place = (str(side), str(specification))
        found.append(_entry(part, plan, *place))
        motions = sorted(set(part["motion"]))
        for motion in motions if len(motions) > 1 else []:
            found.append(_entry(part[part["motion"] == motion], plan, *place, motion=motion))
        found.extend(_people(part, plan, *place))
    return found


def _entry(
    part: pd.DataFrame, plan: FitPlan, side: str, specification: str, motion: str = ALL
) -> Entry:
    data = people_counts(part["participant"], part["level"], part["correct"])
    summary = summarise(
        data,
        plan.what,
        plan.at,
        interval="people" if len(data.people) > 1 else "profile",
        samples=plan.samples,
        rng=np.random.default_rng(plan.seed),
    )
    found = staircase_threshold(tracks(part))
    return Entry(side, specification, motion, ALL, data, summary, found)


def _people(part: pd.DataFrame, plan: FitPlan, side: str, specification: str) -> list[Entry]:
    """Each person's fit over all motions; none where there is but one person."""
    data = people_counts(part["participant"], part["level"], part["correct"])
    if len(data.people) < 2:
        return []
    samples = min(plan.samples, PERSON_SAMPLES)
    rng = np.random.default_rng(plan.seed)
    fits = summarise_each(data, plan.what, plan.at, samples=samples, rng=rng)
    ran: dict[str, list[AnsweredTrack]] = {person: [] for person in data.people}
    for track in tracks(part):
        ran[track.participant].append(track)
    return [
        Entry(side, specification, ALL, person, data.of(row), fit, staircase_threshold(ran[person]))
        for row, (person, fit) in enumerate(zip(data.people, fits, strict=True))
    ]


def signed_threshold(entry: Entry, number: int = 0) -> Threshold:
    """The entry's threshold with its sign, ends in ascending order."""
    plain = entry.summary.thresholds[number]
    return plain if entry.sign > 0 else plain.signed_down
