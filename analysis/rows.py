"""The rows of a record: which columns a task has, what they hold, and which rows do not.

Every cell arrives as text, blanks at its ends stripped. A row with a cell that cannot be what its
column says is named and left out; columns that can be worked out from others are, so that older
records and tables made by hand are read for what they hold.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd

from analysis.delimited import is_comma_number, plain_minus

_MISSING = ("n/a", "", "nan", "NaN", "NA")

NUMBERS = frozenset(
    {"onset", "response_time", "reference_length", "length", "difference", "rating",
     "late_frames", "trial", "odd_pair", "position", "repeat_of", "level"}
)  # fmt: skip
FLAGS = frozenset({"void", "correct"})
FLAG_WORDS = {"1": 1.0, "0": 0.0, "true": 1.0, "false": 0.0, "1.0": 1.0, "0.0": 0.0, "yes": 1.0,
              "no": 0.0, "right": 1.0, "wrong": 0.0, "correct": 1.0, "incorrect": 0.0,
              "t": 1.0, "f": 0.0, "y": 1.0, "n": 0.0}  # fmt: skip
# Answers to “which of the two?” that name neither: ties, not silence.
TIE_WORDS = frozenset(
    {"equal", "equally", "tie", "tied", "same", "both", "neither", "draw", "no preference",
     "no difference", "undecided", "indifferent", "="}
)  # fmt: skip
_FIRST, _SECOND = ("first", "1", "left"), ("second", "2", "right")
CHOICE_WORDS = frozenset({*_FIRST, *_SECOND})

Derive = Callable[[pd.DataFrame], pd.Series]


@dataclass(frozen=True)
class TaskColumns:
    """What a task's rows must hold (`needed`), may leave open (`open`), and what is derived."""

    needed: tuple[str, ...]
    open: tuple[str, ...]
    derived: tuple[tuple[str, tuple[str, ...], Derive], ...]


def difference_of_lengths(t: pd.DataFrame) -> pd.Series:
    return t["length"] - t["reference_length"]


def _side(t: pd.DataFrame) -> pd.Series:
    return pd.Series(np.where(t["difference"] < 0, "shorter", "longer"), t.index, dtype=object)


def correct_of_response(t: pd.DataFrame) -> pd.Series:
    """Whether the response names the odd pair; nan where it names none."""
    answer = pd.to_numeric(t["response"], errors="coerce")
    known = answer.notna() & t["odd_pair"].notna()
    return (answer == t["odd_pair"]).astype(float).where(known)


def chosen_by_response(t: pd.DataFrame) -> pd.Series:
    """The method that the response, first or second, stands for."""
    answer = t["response"].map(_lower)
    second = t["second_method"].where(answer.isin(_SECOND))
    return t["first_method"].where(answer.isin(_FIRST), second)


def _lower(value: object) -> object:
    return value.lower() if isinstance(value, str) else value


def _clip(t: pd.DataFrame) -> pd.Series:
    return t["clip_a"]


def _level(t: pd.DataFrame) -> pd.Series:
    return t["level"]


COLUMNS: dict[str, TaskColumns] = {
    "odd-pair": TaskColumns(
        ("difference",),
        ("correct",),
        (
            ("difference", ("length", "reference_length"), difference_of_lengths),
            ("difference", ("level",), _level),
            ("track", ("difference",), _side),
            ("correct", ("response", "odd_pair"), correct_of_response),
        ),
    ),
    "preference": TaskColumns(
        ("first_method", "second_method"),
        ("chosen_method",),
        (("chosen_method", ("response", "first_method", "second_method"), chosen_by_response),),
    ),
    "rating": TaskColumns(("question",), ("rating",), ()),
    "natural": TaskColumns((), ("response",), (("clip", ("clip_a",), _clip),)),
}

# The columns by which a table without a sidecar is known.
TELLING = {
    "odd-pair": (
        {"odd_pair"},
        {"difference"},
        {"reference_length"},
        {"track", "correct"},
        {"level", "correct"},
    ),
    "preference": ({"chosen_method"}, {"first_method"}),
    "rating": ({"rating"},),
    "natural": ({"clip", "response"}, {"clip_a", "response"}),
}

EXPECTED = (
    "difference (or length and reference_length, or level) and correct; first_method, "
    "second_method and chosen_method; question and rating; or clip and response"
)


def task_of(header: list[str]) -> str | None:
    """The task whose columns these are, or None."""
    found = set(header)
    for task, choices in TELLING.items():
        if any(choice <= found for choice in choices):
            return task
    return None


def typed_rows(task: str, table: pd.DataFrame, where: str) -> tuple[pd.DataFrame, list[str]]:
    """Typed rows of a table of text whose index is the line number, and what was wrong.

    Preferences get a column `tie`: answered, but with neither method.
    """
    columns = COLUMNS[task]
    faults: dict[int, str] = {}
    typed = _typed(table, faults)
    for column, sources, derive in columns.derived:
        if column not in typed and set(sources) <= set(typed):
            typed[column] = derive(typed)
    absent = [column for column in columns.needed + columns.open if column not in typed]
    if absent:
        lacking = (
            f"{where}: expected a column {absent[0]}, found {', '.join(table.columns)[:300]}; "
            "the table is left out"
        )
        return typed.iloc[:0].reindex(columns=[*typed, *absent]), [lacking]
    for column in columns.needed:
        for line in typed.index[typed[column].isna()]:
            faults.setdefault(line, f"{column} is missing")
    if task == "preference":
        typed = _ties(typed)
    for line, what in _inconsistent(task, typed):
        faults.setdefault(line, what)
    told = [f"{where}:{line}: {faults[line]}; the row is left out" for line in sorted(faults)]
    return typed.drop(index=list(faults)), told


def _typed(table: pd.DataFrame, faults: dict[int, str]) -> pd.DataFrame:
    """Numbers and flags read from text; cells that hold neither go to `faults` by line."""
    text = table.where(~table.isin(_MISSING))
    typed = text.astype(object).copy()
    for column in text.columns:
        if column not in NUMBERS and column not in FLAGS:
            continue
        if column in FLAGS:
            values = text[column].astype(object).str.lower().map(FLAG_WORDS)
        else:
            values = pd.to_numeric(text[column], errors="coerce").astype(float)
            odd = values.isna() & text[column].notna()
            if odd.any():
                again = text.loc[odd, column].map(_number_text)
                values[odd] = pd.to_numeric(again, errors="coerce").astype(float)
        wrong = text[column].notna() & ~np.isfinite(values.astype(float))
        for line in table.index[wrong]:
            faults.setdefault(line, _unlike(column, table.at[line, column]))
        typed[column] = values.astype(float)
    return typed


def _number_text(cell: object) -> object:
    """A number's text with the keyboard's minus; a decimal comma (not 1,000) as a point."""
    if not isinstance(cell, str):
        return cell
    plain = plain_minus(cell)
    if is_comma_number(plain) and len(plain.partition(",")[2]) != 3:
        return plain.replace(",", ".")
    return plain


def _ties(typed: pd.DataFrame) -> pd.DataFrame:
    """Preferences with `tie` true where the answer was that the two are equal."""
    tie = pd.Series(False, typed.index)
    for column in ("response", "chosen_method"):
        if column in typed:
            tie |= typed[column].map(_lower).isin(TIE_WORDS)
    chosen = typed["chosen_method"].where(~typed["chosen_method"].map(_lower).isin(TIE_WORDS))
    return typed.assign(chosen_method=chosen, tie=tie & chosen.isna())


def _unlike(column: str, found: object) -> str:
    expected = "0 or 1" if column in FLAGS else "a number"
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
