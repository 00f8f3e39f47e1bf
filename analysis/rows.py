"""The rows of a record: which columns a task has, what they hold, and which rows do not.

Every cell arrives as text. A row with a cell that cannot be what its column says is named and
left out; columns that can be worked out from others are, so that older records and tables made
by hand are read for what they hold.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd

MISSING = ("n/a", "", "nan", "NaN", "NA")

NUMBER = frozenset(
    {"onset", "response_time", "reference_length", "length", "difference", "rating",
     "late_frames", "trial", "odd_pair", "position", "repeat_of"}
)  # fmt: skip
FLAG = frozenset({"void", "correct"})
FLAGS = {"1": 1.0, "0": 0.0, "true": 1.0, "false": 0.0, "1.0": 1.0, "0.0": 0.0, "yes": 1.0,
         "no": 0.0}  # fmt: skip

Derive = Callable[[pd.DataFrame], pd.Series]


@dataclass(frozen=True)
class Task:
    """What a task's rows must hold (`needed`), may leave open (`open`), and what is derived."""

    needed: tuple[str, ...]
    open: tuple[str, ...]
    derived: dict[str, tuple[tuple[str, ...], Derive]]


def _difference(t: pd.DataFrame) -> pd.Series:
    return t["length"] - t["reference_length"]


def _side(t: pd.DataFrame) -> pd.Series:
    return pd.Series(np.where(t["difference"] < 0, "shorter", "longer"), t.index, dtype=object)


def _correct(t: pd.DataFrame) -> pd.Series:
    answer = pd.to_numeric(t["response"], errors="coerce")
    return (answer == t["odd_pair"]).astype(float).where(answer.notna())


def _chosen(t: pd.DataFrame) -> pd.Series:
    second = t["second_method"].where(t["response"] == "second")
    return t["first_method"].where(t["response"] == "first", second)


def _clip(t: pd.DataFrame) -> pd.Series:
    return t["clip_a"]


TASKS: dict[str, Task] = {
    "odd-pair": Task(
        ("difference",),
        ("correct",),
        {
            "difference": (("length", "reference_length"), _difference),
            "track": (("difference",), _side),
            "correct": (("response", "odd_pair"), _correct),
        },
    ),
    "preference": Task(
        ("first_method", "second_method"),
        ("chosen_method",),
        {"chosen_method": (("response", "first_method", "second_method"), _chosen)},
    ),
    "rating": Task(("question",), ("rating",), {}),
    "natural": Task((), ("response",), {"clip": (("clip_a",), _clip)}),
}

# The columns by which a table without a sidecar is known.
TELLING = {
    "odd-pair": ({"odd_pair"}, {"difference"}, {"reference_length"}, {"track", "correct"}),
    "preference": ({"chosen_method"}, {"first_method"}),
    "rating": ({"rating"},),
    "natural": ({"clip", "response"}, {"clip_a", "response"}),
}


def task_of(header: list[str]) -> str | None:
    """The task whose columns these are, or None."""
    found = set(header)
    for task, choices in TELLING.items():
        if any(choice <= found for choice in choices):
            return task
    return None


def parse(task: str, table: pd.DataFrame, where: str) -> tuple[pd.DataFrame, list[str]]:
    """Typed rows of a table of text whose index is the line number, and what was wrong."""
    rules = TASKS[task]
    text = table.where(~table.isin(MISSING))
    faults: dict[int, str] = {}
    typed = text.astype(object).copy()
    for column in text.columns:
        if column not in NUMBER and column not in FLAG:
            continue
        if column in FLAG:
            values = text[column].astype(object).str.lower().map(FLAGS)
        else:
            values = pd.to_numeric(text[column], errors="coerce")
        wrong = text[column].notna() & ~np.isfinite(values.astype(float))
        for line in table.index[wrong]:
            faults.setdefault(line, _unlike(column, table.at[line, column]))
        typed[column] = values.astype(float)
    for column, (sources, derive) in rules.derived.items():
        if column not in typed and set(sources) <= set(typed):
            typed[column] = derive(typed)
    absent = [column for column in rules.needed + rules.open if column not in typed]
    if absent:
        lacking = (
            f"{where}: expected a column {absent[0]}, found {', '.join(table.columns)}; "
            "the table is left out"
        )
        return typed.iloc[:0].reindex(columns=[*typed, *absent]), [lacking]
    for column in rules.needed:
        for line in typed.index[typed[column].isna()]:
            faults.setdefault(line, f"{column} is missing")
    for line, what in _inconsistent(task, typed):
        faults.setdefault(line, what)
    told = [f"{where}:{line}: {faults[line]}; the row is left out" for line in sorted(faults)]
    return typed.drop(index=list(faults)), told


def _unlike(column: str, found: object) -> str:
    expected = "0 or 1" if column in FLAG else "a number"
    return f"{column}: expected {expected}, found {str(found)[:40]!r}"


def _inconsistent(task: str, t: pd.DataFrame) -> list[tuple[int, str]]:
    """Rows whose cells are well formed but cannot be true."""
    if task == "odd-pair":
        return [
            (line, "difference is 0, so no pair differs") for line in t.index[t["difference"] == 0]
        ]
    if task == "preference":
        chosen = t["chosen_method"]
        other = chosen.notna() & (chosen != t["first_method"]) & (chosen != t["second_method"])
        return [
            (line, f"chosen_method {str(chosen[line])[:40]!r} is neither of the two shown")
            for line in t.index[other]
        ]
    if task == "natural":
        odd = t["response"].notna() & ~t["response"].isin(["natural", "unnatural"])
        return [
            (
                line,
                f"response: expected natural or unnatural, found "
                f"{str(t.at[line, 'response'])[:40]!r}",
            )
            for line in t.index[odd]
        ]
    return []
