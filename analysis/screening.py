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
Rule = Callable[[pd.DataFrame, pd.DataFrame, float, str], pd.Series]


def _of_people(table: pd.DataFrame, people: pd.Index) -> pd.Series:
    return table["participant"].isin(people)


def _catch_below(main: pd.DataFrame, catch: pd.DataFrame, limit: float, answer: str) -> pd.Series:
    if len(catch) == 0 or "correct" not in catch:
        return pd.Series(False, main.index)
    right = catch["correct"].fillna(0).astype(float).groupby(catch["participant"]).mean()
    return _of_people(main, right.index[right < limit])


def _missing_above(main: pd.DataFrame, catch: pd.DataFrame, limit: float, answer: str) -> pd.Series:
    missing = main[answer].isna().groupby(main["participant"]).mean()
    return _of_people(main, missing.index[missing > limit])


def _time(main: pd.DataFrame) -> pd.Series:
    if "response_time" not in main:
        return pd.Series(float("nan"), main.index)
    return main["response_time"].astype(float)


RULES: dict[str, tuple[str, Rule]] = {
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


def stated_rules(protocol: dict[str, Any]) -> list[tuple[str, str, Rule, float]]:
    """The protocol's own rules: key, words, rule and limit; a limit must be a number."""
    settings = protocol.get("analysis")
    settings = settings if isinstance(settings, dict) else {}
    return [
        (key, words.format(settings[key]), rule, float(settings[key]))
        for key, (words, rule) in RULES.items()
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
    # A comparison question has no method, but its rating is as good as any.
    exclusions.append(Exclusion("trials without an answer", (), int(open_rows.sum())))
    return Screened(main[~open_rows], catch, int((phase == "practice").sum()), tuple(exclusions))
