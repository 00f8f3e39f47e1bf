"""Records that repeat: rows saved twice, runs and people copied, names that may be one.

What stands twice is counted once. Two people may well answer alike, so that equal rows alone are
no copy: answering times that are equal are, and without times answers that so many people would
not give alike by chance.
"""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import pandas as pd

from analysis.consistency import line_ranges
from analysis.psychometric.functions import Array

_NAMED = ("participant", "method", "first_method", "second_method", "chosen_method", "motion",
          "category", "question")  # fmt: skip
_ANSWERS = ("response", "chosen_method", "correct", "rating")
_TIME = "response_time"  # of people, never the same twice; onsets may be a script's
_WHO = ("participant", "run", "session", "tie")
FEWEST_TIMES = 3  # rows whose times must agree
UNLIKELY = 1e-3  # chance of any two people of a table answering alike
_ABSENT = "\0"


@dataclass(frozen=True, eq=False)
class Unit:
    """What one person answered in one run: which table (by number), whose, and the rows."""

    table: int
    where: str
    person: str
    rows: pd.DataFrame


def once(table: pd.DataFrame, where: str, person: str) -> tuple[pd.DataFrame, list[str]]:
    """The rows of a table without those that stand again, whole, and what was said of them.

    Only a number or a time of the trial tells a row saved twice from two trials alike.
    """
    if not {"trial", "onset"} & set(table):
        return table, []
    marks = [name for name in ("participant", "trial", "onset") if name in table]
    again = table.duplicated(marks)  # few columns first: whole rows take longer to compare
    if again.any():
        again = table.duplicated()
    if not again.any():
        return table, []
    who = table["participant"] if "participant" in table else pd.Series(person, table.index)
    told = [
        f"{where}: {name}, {line_ranges(part.index)} ({len(part)}) stand twice (same person, trial "
        "and answer); they are counted once"
        for name, part in table[again].groupby(who[again].astype(str), sort=True)
    ]
    return table[~again], told


def units_of(number: int, where: str, person: str, table: pd.DataFrame) -> list[Unit]:
    """The units of one table, which may name people and runs row by row."""
    keys = [table[name].astype(str) for name in ("participant", "session", "run") if name in table]
    if not keys:
        return [Unit(number, where, person, table)]
    names = table["participant"].astype(str) if "participant" in table else None
    return [
        Unit(number, where, person if names is None else str(names[part.index[0]]), part)
        for _, part in table.groupby(keys, sort=False)
    ]


def copies(units: list[Unit]) -> list[tuple[Unit, Unit]]:
    """Units that are a copy of an earlier one, each with the one that it is a copy of."""
    first: dict[tuple[object, ...], Unit] = {}
    pairs = []
    glances = [_glance(unit.rows) for unit in units]
    seen = Counter(glances)
    for unit, glance in zip(units, glances, strict=True):
        if seen[glance] == 1:  # nothing begins alike, so that nothing is a copy of it
            continue
        key = _content(unit.rows)
        if key and key in first:
            pairs.append((unit, first[key]))
        else:
            first[key] = unit
    if not pairs:
        return []
    frequencies = _frequencies(units)
    chance = UNLIKELY / max(len(units) * (len(units) - 1) / 2, 1)
    return [
        pair
        for pair in pairs
        if _timed(pair[0].rows) or _alike_by_chance(pair[0].rows, frequencies) < chance
    ]


def _glance(rows: pd.DataFrame) -> tuple[object, ...]:
    """How many rows there are, and one column of answers: copies agree in that."""
    name = next((name for name in _ANSWERS if name in rows), None)
    return (len(rows), *(map(str, rows[name]) if name else ()))


def _content(rows: pd.DataFrame) -> tuple[object, ...]:
    kept = rows[sorted(column for column in rows if column not in _WHO)]
    plain = kept.astype(object).where(kept.notna(), _ABSENT)
    return (tuple(kept), *(tuple(row) for row in plain.itertuples(index=False)))


def _timed(rows: pd.DataFrame) -> bool:
    return _TIME in rows and rows[_TIME].nunique() >= FEWEST_TIMES


def _frequencies(units: list[Unit]) -> dict[str, pd.Series]:
    whole = pd.concat([unit.rows for unit in units], ignore_index=True)
    return {
        name: whole[name].value_counts(normalize=True, dropna=False)
        for name in _ANSWERS
        if name in whole
    }


def _alike_by_chance(rows: pd.DataFrame, frequencies: dict[str, pd.Series]) -> float:
    """How probable these answers are, by the column of answers that varies least."""
    held = [
        float(np.exp(np.log(rows[name].map(shares).astype(float)).sum()))
        for name, shares in frequencies.items()
        if name in rows
    ]
    return max(held, default=1.0)


def lookalikes(names: Iterable[str]) -> list[tuple[str, ...]]:
    """Names that differ in case, inner blanks, or leading zeros of a number alone."""
    groups: dict[str, set[str]] = {}
    for name in names:
        groups.setdefault(_bare(name), set()).add(name)
    return [tuple(sorted(group)) for _, group in sorted(groups.items()) if len(group) > 1]


def _bare(name: str) -> str:
    plain = "".join(name.split()).replace("_", "-").casefold()
    return plain.lstrip("0") or "0" if plain.isdigit() else plain


def doubtful_names(trials: pd.DataFrame, where: str) -> list[str]:
    """A question for each set of names that may be one; they are counted as they stand."""
    told = []
    columns: dict[str, Array] = {}
    for column in _NAMED:
        if column in trials:
            kind = "method" if column.endswith("method") else column
            values = trials[column].dropna().astype(str).unique()
            columns[kind] = np.union1d(columns.get(kind, np.array([], str)), values.astype(str))
    for kind, values in columns.items():
        for group in lookalikes(map(str, values)):
            listed = " and ".join(f"“{name}”" for name in group)
            told.append(
                f"{where}: {kind} {listed}: are these one? They are counted as "
                f"{len(group)}; write the name in one way if they are"
            )
    return told
