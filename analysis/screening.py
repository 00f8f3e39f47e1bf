"""What is left out before any statistic, and by which rule.

Practice, catch and void trials never count. A protocol's `[analysis]` may state further rules,
keys that begin with `exclude_`: they are applied here, before the answers of interest are looked
at, and the report states them before the data.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pandas as pd

from analysis.record import Study


@dataclass(frozen=True)
class Exclusion:
    """A rule, what it took out, and how many trials that was."""

    rule: str
    participants: tuple[str, ...]
    trials: int


@dataclass(frozen=True, eq=False)
class Screened:
    """The trials that count, those set apart by phase, and every exclusion by rule."""

    main: pd.DataFrame
    catch: pd.DataFrame
    practice: int
    exclusions: tuple[Exclusion, ...]
    left_out: tuple[tuple[str, str], ...] = ()  # people of whom no trial counts, each with why

    @property
    def people(self) -> tuple[str, ...]:
        """Everyone whose answers are analysed."""
        return tuple(sorted(set(self.main["participant"].astype(str)))) if len(self.main) else ()

    @property
    def excluded(self) -> int:
        return sum(exclusion.trials for exclusion in self.exclusions)


ANSWER = {
    "odd-pair": "correct",
    "preference": "chosen_method",
    "rating": "rating",
    "natural": "response",
}

# A rule says which rows of the main trials go, from those trials, the catch trials and the limit.
ScreeningRule = Callable[[pd.DataFrame, pd.DataFrame, float, str], pd.Series]


def _of_people(table: pd.DataFrame, people: pd.Index) -> pd.Series:
    return table["participant"].isin(people)


def _catch_below(main: pd.DataFrame, catch: pd.DataFrame, limit: float, answer: str) -> pd.Series:
    if len(catch) == 0 or "correct" not in catch:
        return pd.Series(False, main.index)
    right = catch["correct"].fillna(0).astype(float).groupby(catch["participant"]).mean()
    return _of_people(main, right.index[right < limit])


def _missing_above(main: pd.DataFrame, catch: pd.DataFrame, limit: float, answer: str) -> pd.Series:
    open_rows = main[answer].isna()
    if "tie" in main:
        open_rows &= ~main["tie"].astype(bool)
    missing = open_rows.groupby(main["participant"]).mean()
    return _of_people(main, missing.index[missing > limit])


def _time(main: pd.DataFrame) -> pd.Series:
    if "response_time" not in main:
        return pd.Series(float("nan"), main.index)
    return main["response_time"].astype(float)


_SCREENING: dict[str, tuple[str, ScreeningRule]] = {
    "exclude_catch_below": ("people with fewer than {:.0%} of catch trials right", _catch_below),
    "exclude_missing_above": ("people with more than {:.0%} of trials unanswered", _missing_above),
    "exclude_faster_than": (
        "trials answered in less than {:g} s",
        lambda main, catch, limit, answer: _time(main) < limit,
    ),
    "exclude_slower_than": (
        "trials answered in more than {:g} s",
        lambda main, catch, limit, answer: _time(main) > limit,
    ),
    "exclude_fewer_trials": (
        "people with fewer than {:g} trials",
        lambda main, catch, limit, answer: (
            main.groupby("participant")["participant"].transform("size") < limit
        ),
    ),
}


def stated_rules(protocol: dict[str, Any]) -> list[tuple[str, str, ScreeningRule, float]]:
    """The protocol's own rules: key, words, rule and limit; a limit must be a number."""
    settings = protocol.get("analysis")
    settings = settings if isinstance(settings, dict) else {}
    return [
        (key, words.format(settings[key]), rule, float(settings[key]))
        for key, (words, rule) in _SCREENING.items()
        if isinstance(settings.get(key), int | float)
    ]


def screen(study: Study) -> Screened:
    """Split the trials of a study by phase and apply the rules, in the order of the table."""
    table = study.trials
    phase = table["phase"].fillna("main") if "phase" in table else pd.Series("main", table.index)
    main, catch = table[phase == "main"], table[phase == "catch"]
    exclusions = []
    if "void" in table:
        void = main["void"].fillna(0) == 1
        exclusions.append(Exclusion("void trials (shown too late)", (), int(void.sum())))
        main, catch = main[~void], catch[catch["void"].fillna(0) != 1]
    answer = ANSWER[study.task]
    for _, words, rule, limit in stated_rules(study.protocol):
        out = rule(main, catch, limit, answer)
        gone = set(main["participant"]) - set(main.loc[~out, "participant"])
        exclusions.append(Exclusion(words, tuple(sorted(map(str, gone))), int(out.sum())))
        main = main[~out]
    open_rows = main[answer].isna()
    if "tie" in main:  # an answer, although it names neither method
        open_rows &= ~main["tie"].astype(bool)
    # A comparison question has no method, but its rating is as good as any.
    exclusions.append(Exclusion("trials without an answer", (), int(open_rows.sum())))
    kept = main[~open_rows]
    reasons = _reasons(study, set(kept["participant"].astype(str)), exclusions)
    practice = int((phase == "practice").sum())
    return Screened(kept, catch, practice, tuple(exclusions), reasons)


def _reasons(
    study: Study, kept: set[str], exclusions: list[Exclusion]
) -> tuple[tuple[str, str], ...]:
    """Why each person who was recorded is not among those analysed: the first rule that says so."""
    recorded = set(study.people) | set(study.trials["participant"].astype(str))
    told = []
    for person in sorted(recorded - kept):
        rules = [rule.rule for rule in exclusions if person in rule.participants]
        told.append((person, rules[0] if rules else _otherwise(study, person)))
    return tuple(told)


def _otherwise(study: Study, person: str) -> str:
    if person not in set(study.trials["participant"].astype(str)):
        return "no row of theirs can be used, as told below"
    return "no trial of theirs counts: practice, void or unanswered"
