"""One table of a record and its sidecar: a session, read leniently.

A missing sidecar, missing columns and malformed rows are named in `faults`, and everything else is
kept. Rows that repeat or contradict themselves are named in `remarks`, with what is done about
them.
"""

import csv
import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from analysis.consistency import consistent
from analysis.delimited import decoded, is_blank, renamed, separator_of, told_separator
from analysis.repeats import once
from analysis.rows import COLUMNS, EXPECTED, task_of, typed_rows

_ENTITIES = re.compile(r"(?:^|_)(?P<key>[a-z]+)-(?P<value>[^_]+)")


@dataclass(frozen=True, eq=False)
class Session:
    """One table: its rows typed, its sidecar, and what was wrong with it."""

    participant: str
    run: str
    path: Path
    task: str
    name: str  # the protocol's name, or the task label of the file
    sidecar: dict[str, Any]
    trials: pd.DataFrame
    faults: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    people: tuple[str, ...] = ()  # everyone whom the table names, whatever is left of their rows

    @property
    def protocol(self) -> dict[str, Any]:
        found = self.sidecar.get("Protocol")
        return found if isinstance(found, dict) else {}

    @property
    def kept_apart(self) -> str | None:
        """Why the session is never pooled: it is a "rehearsal", or it was "paced"; else None."""
        if self.sidecar.get("Rehearsal"):
            return "rehearsal"
        pace = self.sidecar.get("Pace", 1.0)
        return "paced" if isinstance(pace, int | float) and float(pace) != 1.0 else None

    @property
    def windowless(self) -> bool:
        """Whether the session ran without a window: no frame of it was ever shown."""
        display = self.sidecar.get("Display")
        return isinstance(display, dict) and display.get("kind") == "none"


def read_session(path: Path, columns: dict[str, str]) -> Session | str:
    """The session in a table, or why it is none."""
    try:
        text = decoded(path.read_bytes(), errors="replace")
    except OSError as error:
        return f"{path}: cannot be read ({error.strerror}); it is left out"
    table, ragged = table_of(lines_of(text), "," if path.suffix == ".csv" else "\t", path)
    try:
        table.columns = renamed(list(table.columns), columns)
    except KeyError as missing:
        return (
            f"{path}: --columns: expected a column {missing.args[0]}, "
            f"found {', '.join(table.columns)[:300]}"
        )
    sidecar, complaint = read_object(path.with_suffix(".json"))
    protocol = sidecar.get("Protocol")
    protocol = protocol if isinstance(protocol, dict) else {}
    task = protocol.get("task") or task_of(list(table.columns))
    if task not in COLUMNS or task_of(list(table.columns)) is None:
        return (
            f"{path}: expected the columns of a record: {EXPECTED}; found "
            f"{', '.join(table.columns)[:300] or 'none'}. Name them with --columns, as in "
            "--columns participant=subj,level=stim,correct=acc"
        )
    trials, faults = typed_rows(str(task), table, str(path))
    entities = {found["key"]: found["value"] for found in _ENTITIES.finditer(path.stem)}
    participant = entities.get("sub") or path.stem.removesuffix("_beh")
    people = tuple(
        sorted(set(trials["participant"].astype(str))) if "participant" in trials else [participant]
    )
    trials, repeated = once(trials, str(path), participant)
    trials, contradicted = consistent(str(task), trials, str(path), participant)
    label = entities["task"] if "sub" in entities and "task" in entities else path.stem
    if "sub" not in entities and "protocol" in trials:
        label = str(trials["protocol"].iloc[0]) if len(trials) else label
    return Session(
        participant=participant,
        run="-".join(entities[key] for key in ("ses", "acq", "run") if key in entities) or "1",
        path=path,
        task=str(task),
        name=str(protocol.get("name") or sidecar.get("TaskName") or label),
        sidecar=sidecar,
        trials=trials,
        faults=(*complaint, *ragged, *faults),
        remarks=(*repeated, *contradicted),
        people=people,
    )


def table_of(rows: list[str], otherwise: str, path: Path) -> tuple[pd.DataFrame, list[str]]:
    """The cells as text without blanks at their ends, indexed by line number.

    Lines of another width are left out, lines of separators alone passed over. The header, or a
    line `sep=;` before it, tells the separator, `otherwise` where neither does.
    """
    told = told_separator(rows[0]) if rows else None
    begin = 0 if told is None else 1
    while begin < len(rows) and is_blank(re.split(r"[,;\t]", rows[begin])):
        begin += 1
    if begin >= len(rows):
        return pd.DataFrame(), [f"{path}: expected a header, found an empty file"]
    delimiter = told or separator_of(rows[begin], otherwise)
    header = [name.strip() for name in _cells(rows[begin], delimiter)]
    faults, kept, numbers = [], [], []
    for number, row in enumerate(rows[begin + 1 :], start=begin + 2):
        cells = _cells(row, delimiter)
        if is_blank(cells):
            continue
        if len(cells) == len(header):
            kept.append([cell.strip() for cell in cells])
            numbers.append(number)
        else:
            faults.append(
                f"{path}:{number}: expected {len(header)} cells, found {len(cells)}; "
                "the row is left out"
            )
    table = pd.DataFrame(kept, index=numbers, columns=header, dtype=object)
    twice = table.columns.duplicated()
    if twice.any():
        names = ", ".join(sorted(set(table.columns[twice])))
        faults.append(f"{path}: expected each column once, found {names} again; the first is read")
    return table.loc[:, ~twice], faults


def _cells(row: str, delimiter: str) -> list[str]:
    """The cells of one line: read line by line, a stray quotation mark spoils one row only."""
    try:
        return next(csv.reader([row], delimiter=delimiter), [])
    except csv.Error:
        return [row]


def lines_of(text: str) -> list[str]:
    """Lines ended by \\n or \\r\\n alone: a comment may hold other separators."""
    return [line.removesuffix("\r") for line in text.removesuffix("\n").split("\n")]


def read_object(path: Path) -> tuple[dict[str, Any], list[str]]:
    """A sidecar or a manifest entry, and what was wrong with it."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}, []
    except (OSError, ValueError) as error:
        return {}, [f"{path}: not readable as JSON ({error}); the table is read without it"]
    if not isinstance(found, dict):
        return {}, [f"{path}: expected a JSON object; the table is read without it"]
    return found, []
