"""A table of counts or single trials from a CSV file, and the options of a fit from text."""

import csv
import re
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

from analysis.delimited import (
    columns_from,
    is_blank,
    is_thousands,
    plain_minus,
    renamed,
    separator_of,
    told_separator,
)
from analysis.errors import InputError
from analysis.psychometric.counts import Counts, counts
from analysis.psychometric.fit import Setting
from analysis.psychometric.summary import SAMPLES

_MOST_FAULTS = 3
_WORDS = {"true": 1.0, "yes": 1.0, "right": 1.0, "correct": 1.0, "t": 1.0, "y": 1.0,
          "false": 0.0, "no": 0.0, "wrong": 0.0, "incorrect": 0.0, "f": 0.0, "n": 0.0}  # fmt: skip


@dataclass(frozen=True)
class DelimitedTable:
    """A CSV: the names of its columns, and its rows that are not empty, each with its line."""

    separator: str
    header: list[str]
    rows: list[tuple[int, list[str]]]


def read_table(path: Path) -> DelimitedTable:
    """A CSV file separated by commas, semicolons or tabs, whichever the header has most of.

    InputError where it cannot be read, which says why in words.
    """
    text = _text(path)
    first = next((line for line in text.splitlines() if line.strip()), "")
    told = told_separator(first)
    if told:
        begin = text.index(first)
        after = text[begin:].partition("\n")[2]
        text = "\n" * (text[:begin].count("\n") + 1) + after  # line numbers stay those of the file
        first = next((line for line in after.splitlines() if line.strip()), "")
    separator = told or separator_of(first)
    reader = csv.reader(StringIO(text, newline=""), delimiter=separator)
    try:
        rows = [(reader.line_num, row) for row in reader if not is_blank(row)]
    except csv.Error:
        raise InputError(
            f"{path}:{reader.line_num}: expected a CSV table, found a field longer than "
            f"{csv.field_size_limit()} letters; is a quotation mark left open?"
        ) from None
    return DelimitedTable(
        separator, [name.strip() for name in rows[0][1]] if rows else [], rows[1:]
    )


def _text(path: Path) -> str:
    """What a file says in UTF-8; InputError for what is none."""
    try:
        data = path.read_bytes()
    except OSError as error:
        missing = isinstance(error, FileNotFoundError)
        found = "no such file" if missing else (error.strerror or "none that can be read").lower()
        found = found.removeprefix("is ")  # a directory
        raise InputError(f"{path}: expected a CSV table, found {found}.") from None
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = "\0"
    if "\0" in text:  # UTF-16 without its mark decodes
        wide = data[:2] in (b"\xff\xfe", b"\xfe\xff") or b"\0" in data
        found = "UTF-16" if wide else "another encoding"
        raise InputError(
            f"{path}: expected a CSV table in UTF-8, found {found}.\nSave it as CSV UTF-8."
        )
    return text


def read_counts(path: Path, names: dict[str, str] | None = None) -> Counts:
    """Columns level, correct and total, or level and correct (0 or 1) for single trials.

    `names` gives the table's own names for them.
    """
    read = read_table(path)
    try:
        header = [name.lower() for name in renamed(read.header, names or {})]
    except KeyError as missing:
        raise InputError(
            f"{path}: --columns: expected a column {missing.args[0]}, found {','.join(read.header)}"
        ) from None
    twice = sorted({name for name in ("level", "correct", "total") if header.count(name) > 1})
    if twice:
        raise InputError(
            f"{path}: expected each column once, found {' and '.join(twice)} twice; "
            "leave one, or rename the other"
        )
    if not {"level", "correct"} <= set(header):
        raise InputError(
            f"{path}: expected columns level,correct,total or level,correct, "
            f"found {','.join(header) or 'an empty file'}"
        )
    columns = [header.index(name) for name in ("level", "correct", "total") if name in header]
    table = _numbers(path, read, columns, header.index("correct"))
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


def _numbers(path: Path, read: DelimitedTable, columns: list[int], flags: int) -> list[list[float]]:
    """The numbers of `columns`; the column `flags` may hold words for right and wrong."""
    table, faults = [], []
    grouped = {c for c in columns if _in_thousands(read, c)}
    for line, row in read.rows:
        extra = any(field.strip() for field in row[len(read.header) :])
        try:
            if extra:
                raise ValueError
            table.append([_number(row[c], c in grouped, c == flags) for c in columns])
        except (ValueError, IndexError):
            shown = f"{path}:{line}: expected numbers, found {read.separator.join(row)[:60]!r}"
            faults.append(shown + _decimal_comma(row, extra))
    if faults:
        more = f" (and {len(faults) - _MOST_FAULTS} more)" if len(faults) > _MOST_FAULTS else ""
        raise InputError("\n".join(faults[:_MOST_FAULTS]) + more)
    return table


def _in_thousands(read: DelimitedTable, column: int) -> bool:
    """Whether commas in a column stand between thousands: 1,000 where commas separate fields.

    Where semicolons do, a comma may as well be a decimal one.
    """
    cells = [row[column] for _, row in read.rows if column < len(row) and "," in row[column]]
    return read.separator == "," and bool(cells) and all(map(is_thousands, cells))


def _number(cell: str, grouped: bool, flag: bool) -> float:
    """A cell as a number; ValueError for what is none."""
    text = plain_minus(cell.strip())
    if flag and text.lower() in _WORDS:
        return _WORDS[text.lower()]
    return float(text.replace(",", "") if grouped else text)


def _decimal_comma(row: list[str], extra: bool) -> str:
    """What to do about 0,5; empty where a row has no such number.

    Where commas separate, one splits the number: a field more than there are columns.
    """
    if extra:
        return "; more fields than columns: write decimal points, 0.5 for 0,5"
    comma = next((field for field in row if re.fullmatch(r"\s*[-+]?\d*,\d+\s*", field)), None)
    if comma is None:
        return ""
    if is_thousands(comma):
        plain = comma.strip()
        return (
            f"; is {plain} a thousand ({plain.replace(',', '')}) or a decimal comma? "
            "Write it without a comma"
        )
    return f"; a decimal comma: write {comma.strip().replace(',', '.')}"


def columns_of(text: str | None) -> dict[str, str]:
    """The value of `--columns`: our names for a table's own."""
    try:
        return columns_from(text)
    except ValueError:
        raise InputError(
            f"--columns: expected names as in participant=subj,level=stim, found {text!r}"
        ) from None


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
    highest = 1 - (what.lapse or 0.0)  # a free rate may be 0
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
