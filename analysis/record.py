"""Reading records: data sets of sessions, gathered into studies.

A session is one `*_beh.tsv` table with its sidecar; a study is the sessions of one protocol.
Reading is lenient: a missing sidecar, missing columns and malformed rows are named in `faults`,
and everything else is kept.
"""

import csv
import json
import re
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pandas as pd

from analysis.errors import InputError
from analysis.rows import TASKS, parse, task_of

_ENTITIES = re.compile(r"sub-(?P<sub>[^_]+)(?:_task-(?P<task>[^_]+))?(?:_run-(?P<run>[^_]+))?")
_TABLES = ("*_beh.tsv", "*_beh.csv")


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


@dataclass(frozen=True, eq=False)
class Study:
    """The sessions of one protocol; `set_aside` are rehearsed or paced ones, never pooled."""

    name: str
    task: str
    protocol: dict[str, Any]
    sessions: tuple[Session, ...]
    participants: pd.DataFrame = field(default_factory=pd.DataFrame)
    rehearsal: bool = False
    set_aside: tuple[Session, ...] = ()
    stimuli: dict[str, dict[str, Any]] = field(default_factory=dict)  # manifest entries by hash

    @property
    def trials(self) -> pd.DataFrame:
        """All rows of all sessions with `participant` and `session` (a number) added."""
        parts = []
        for number, session in enumerate(self.sessions):
            table = session.trials.assign(session=number)
            if "participant" not in table:  # hand-made tables may name people row by row
                table["participant"] = session.participant
            parts.append(table)
        return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame()

    @property
    def labels(self) -> tuple[str, ...]:
        """What sets this study apart from one that counts: "paced", "rehearsal", both or none."""
        return tuple(sorted({s.kept_apart for s in self.sessions if s.kept_apart}))

    @property
    def faults(self) -> tuple[str, ...]:
        return tuple(fault for session in self.sessions for fault in session.faults)


def read(paths: list[Path]) -> tuple[list[Study], list[str]]:
    """All studies below `paths` (data sets, folders or tables), and what could not be read.

    Raises InputError when a path is absent or no table is found at all.
    """
    sessions: list[Session] = []
    notes: list[str] = []
    people: list[pd.DataFrame] = []
    stimuli: dict[str, dict[str, Any]] = {}
    for path in paths:
        if not path.exists():
            raise InputError(f"{path}: expected a data set or a table, found nothing there")
        for table in _tables(path):
            found = _session(table)
            if isinstance(found, str):
                notes.append(found)
            else:
                sessions.append(found)
        people.append(_participants(path))
        stimuli |= _stimuli(path)
    if not sessions:
        more = "\n" + notes[0] if notes else ""
        raise InputError(
            f"{', '.join(str(path) for path in paths)}: expected session tables "
            f"sub-*/beh/*_beh.tsv, found none that can be read{more}"
        )
    register = pd.concat(people, ignore_index=True)
    studies = _studies(_told_apart(sessions))
    return [
        replace(study, participants=_present(register, study), stimuli=stimuli) for study in studies
    ], notes


def _tables(path: Path) -> list[Path]:
    if path.is_file():
        return [path]
    found = sorted(
        table
        for kind in _TABLES
        for table in path.rglob(kind)
        if not {"derivatives", "sourcedata"} & set(table.relative_to(path).parts)
    )
    if found:
        return found
    return sorted(
        table
        for kind in ("*.tsv", "*.csv")
        for table in path.glob(kind)
        if table.name != "participants.tsv"
    )


def _session(path: Path) -> Session | str:
    """The session in a table, or why it is none."""
    try:
        text = path.read_text(encoding="utf-8-sig", errors="replace")
    except OSError as error:
        return f"{path}: cannot be read ({error.strerror}); it is left out"
    table, ragged = _table(_lines(text), "," if path.suffix == ".csv" else "\t", path)
    sidecar, complaint = _sidecar(path.with_suffix(".json"))
    protocol = sidecar.get("Protocol")
    protocol = protocol if isinstance(protocol, dict) else {}
    task = protocol.get("task") or task_of(list(table.columns))
    if task not in TASKS or task_of(list(table.columns)) is None:
        return f"{path}: expected the columns of a record, found {', '.join(table.columns)[:200]}"
    trials, faults = parse(str(task), table, str(path))
    match = _ENTITIES.search(path.stem)
    participant = match["sub"] if match else path.stem.removesuffix("_beh")
    label = match["task"] if match and match["task"] else path.stem
    if match is None and "protocol" in trials:
        label = str(trials["protocol"].iloc[0]) if len(trials) else label
    return Session(
        participant=participant,
        run=(match["run"] if match else None) or "1",
        path=path,
        task=str(task),
        name=str(protocol.get("name") or sidecar.get("TaskName") or label),
        sidecar=sidecar,
        trials=trials,
        faults=(*complaint, *ragged, *faults),
    )


def _table(rows: list[str], delimiter: str, path: Path) -> tuple[pd.DataFrame, list[str]]:
    """The cells as text, indexed by line number; lines of another width are left out."""
    lines = [_cells(row, delimiter) for row in rows]
    if not lines or not lines[0]:
        return pd.DataFrame(), [f"{path}: expected a header, found an empty file"]
    header, faults, kept, numbers = lines[0], [], [], []
    for number, cells in enumerate(lines[1:], start=2):
        if len(cells) == len(header):
            kept.append(cells)
            numbers.append(number)
        elif cells:
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


def _lines(text: str) -> list[str]:
    """Lines ended by \\n or \\r\\n alone: a comment may hold other separators."""
    return [line.removesuffix("\r") for line in text.removesuffix("\n").split("\n")]


def _sidecar(path: Path) -> tuple[dict[str, Any], list[str]]:
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}, []
    except (OSError, ValueError) as error:
        return {}, [f"{path}: not readable as JSON ({error}); the table is read without it"]
    if not isinstance(found, dict):
        return {}, [f"{path}: expected a JSON object; the table is read without it"]
    return found, []


def _participants(path: Path) -> pd.DataFrame:
    """participants.tsv of a data set, as text; empty when there is none."""
    file = path / "participants.tsv"
    if not file.is_file():
        return pd.DataFrame(columns=["participant_id", "home"])
    table, _ = _table(_lines(file.read_text(encoding="utf-8", errors="replace")), "\t", file)
    return table.reset_index(drop=True).assign(home=str(path.resolve()))


def _stimuli(path: Path) -> dict[str, dict[str, Any]]:
    """The manifest entries of the clips shown, copied beside the record, by hash."""
    found = {}
    for file in sorted((path / "stimuli").glob("*.json")) if path.is_dir() else []:
        entry, faults = _sidecar(file)
        if not faults:
            found[file.stem] = entry
    return found


def _present(register: pd.DataFrame, study: Study) -> pd.DataFrame:
    if "participant_id" not in register:
        return pd.DataFrame()
    ids = register["participant_id"].astype(str).str.removeprefix("sub-")
    present = {(str(_home(s.path)), s.participant.partition("@")[0]) for s in study.sessions}
    kept = [key in present for key in zip(register["home"], ids, strict=True)]
    return register.loc[kept].drop(columns="home")


def _told_apart(sessions: list[Session]) -> list[Session]:
    """Give people of equal ID in different data sets of one study different names."""
    homes: dict[tuple[str, str], set[Path]] = {}
    for session in sessions:
        homes.setdefault((_plain(session.name), session.participant), set()).add(
            _home(session.path)
        )
    return [
        replace(session, participant=f"{session.participant}@{_home(session.path).name}")
        if len(homes[_plain(session.name), session.participant]) > 1
        else session
        for session in sessions
    ]


def _plain(name: str) -> str:
    """A study's name as file labels have it, so that tables with and without sidecar agree."""
    return re.sub(r"[^A-Za-z0-9]", "", name).lower()


def _home(path: Path) -> Path:
    """The data set a table belongs to."""
    return next(
        (folder.parent for folder in path.parents if folder.name.startswith("sub-")), path.parent
    ).resolve()


def _studies(sessions: list[Session]) -> list[Study]:
    """Sessions by protocol and its hash; rehearsed and paced ones apart from those that count."""
    groups: dict[tuple[str, str, str], list[Session]] = {}
    for session in sessions:
        mark = str(session.sidecar.get("ProtocolHash") or "")
        groups.setdefault((_plain(session.name), session.task, mark), []).append(session)
    merged = _adopted(groups)
    studies = []
    for (_, task, _), members in sorted(merged.items()):
        real = [session for session in members if not session.kept_apart]
        trial = [session for session in members if session.kept_apart]
        protocol = next((s.protocol for s in members if s.protocol), {})
        name = str(protocol.get("name") or members[0].name)
        studies.append(
            Study(
                name,
                task,
                protocol,
                tuple(real or trial),
                rehearsal=not real,
                set_aside=tuple(trial) if real else (),
            )
        )
    return studies


def _adopted(
    groups: dict[tuple[str, str, str], list[Session]],
) -> dict[tuple[str, str, str], list[Session]]:
    """Sessions without a protocol's hash join the one version of that name, if there is one."""
    merged = dict(groups)
    for (name, task, mark), members in groups.items():
        versions = [key for key in groups if key[:2] == (name, task) and key[2]]
        if not mark and len(versions) == 1:
            merged[versions[0]] = merged[versions[0]] + members
            del merged[(name, task, mark)]
    return merged
