"""A table of counts or single trials from a CSV file, and the options of a fit from text."""

import csv
from pathlib import Path

from analysis.errors import InputError
from analysis.psychometric.counts import Counts, counts
from analysis.psychometric.fit import MAXIMUM_LAPSE, Setting
from analysis.psychometric.summary import SAMPLES

MOST_FAULTS = 3


def read_counts(path: Path) -> Counts:
    """Columns level, correct and total, or level and correct (0 or 1) for single trials."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"{path}: expected a CSV table, found none that can be read ({error})"
        ) from error
    delimiter = "\t" if "\t" in text.partition("\n")[0] else ","
    rows = [row for row in csv.reader(text.splitlines(), delimiter=delimiter) if row]
    header = [name.strip().lower() for name in rows[0]] if rows else []
    if not {"level", "correct"} <= set(header):
        raise InputError(
            f"{path}: expected columns level,correct,total or level,correct, "
            f"found {','.join(header) or 'an empty file'}"
        )
    columns = [header.index(name) for name in ("level", "correct", "total") if name in header]
    table = _numbers(path, rows[1:], columns)
    if not table:
        raise InputError(f"{path}: expected at least one row of numbers, found none")
    levels, right, *total = map(list, zip(*table, strict=True))
    if not total and set(right) - {0.0, 1.0}:
        raise InputError(
            f"{path}: expected correct to be 0 or 1 in a table of single trials, found "
            f"{next(k for k in right if k not in (0, 1)):g}; add a column total for counts"
        )
    try:
        return counts(levels, right, total[0] if total else None)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _numbers(path: Path, rows: list[list[str]], columns: list[int]) -> list[list[float]]:
    table, faults = [], []
    for line, row in enumerate(rows, start=2):
        try:
            table.append([float(row[column]) for column in columns])
        except (ValueError, IndexError):
            faults.append(f"{path}:{line}: expected numbers, found {','.join(row)[:60]!r}")
    if faults:
        more = f" (and {len(faults) - MOST_FAULTS} more)" if len(faults) > MOST_FAULTS else ""
        raise InputError("\n".join(faults[:MOST_FAULTS]) + more)
    return table


def lapse_of(text: str) -> float | None:
    """`free` (None) or a rate."""
    if text == "free":
        return None
    try:
        return float(text)
    except ValueError:
        raise InputError(f"--lapse: expected free or a rate, found {text!r}") from None


def check_at(at: float, what: Setting) -> None:
    """Raise InputError for a proportion that the function never reaches."""
    highest = 1 - (what.lapse if what.lapse is not None else MAXIMUM_LAPSE)
    if not what.guess < at < highest:
        raise InputError(
            f"--at: expected a proportion between the guess rate and one minus the lapse rate "
            f"({what.guess:g} to {highest:g}), found {at:g}"
        )


def check_samples(samples: int | None) -> int:
    """Bootstrap samples, of which none is as good as the default."""
    if samples is not None and samples < 0:
        raise InputError(f"--bootstrap: expected 0 or more samples, found {samples}")
    return SAMPLES if samples is None else samples
