"""Reading records: data sets of sessions, gathered into studies.

A session is one `*_beh.tsv` table with its sidecar; a study is the sessions of one protocol.
Runs and people that are copies of others are counted once.
"""

import re
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pandas as pd

from analysis.consistency import line_ranges
from analysis.delimited import decoded
from analysis.errors import InputError, NothingAnalysed
from analysis.repeats import copies, doubtful_names, units_of
from analysis.sessions import Session, lines_of, read_object, read_session, table_of

_TABLES = ("*_beh.tsv", "*_beh.csv")


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
    doubts: tuple[str, ...] = ()

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

    @property
    def remarks(self) -> tuple[str, ...]:
        """What repeats or contradicts itself in the records, and what was done about it."""
        return (*(told for session in self.sessions for told in session.remarks), *self.doubts)

    @property
    def people(self) -> tuple[str, ...]:
        """Everyone recorded, also those of whom no row is left."""
        return tuple(sorted({person for session in self.sessions for person in session.people}))


def read(paths: list[Path], columns: dict[str, str] | None = None) -> tuple[list[Study], list[str]]:
    """All studies below `paths` (data sets, folders or tables), and what could not be read.

    `columns` gives the tables' own names for columns of ours. Raises InputError when a path is
    absent or no table is found at all, NothingAnalysed when none has the columns of a record.
    """
    sessions: list[Session] = []
    notes: list[str] = []
    people: list[pd.DataFrame] = []
    stimuli: dict[str, dict[str, Any]] = {}
    for path in paths:
        if not path.exists():
            raise InputError(f"{path}: expected a data set or a table, found nothing there")
        for table in _tables(path):
            found = read_session(table, columns or {})
            if isinstance(found, str):
                notes.append(found)
            else:
                sessions.append(found)
        people.append(_participants(path))
        stimuli |= _stimuli(path)
    if not sessions and notes:
        raise NothingAnalysed(notes[0] + (f" (and {len(notes) - 1} more)" if notes[1:] else ""))
    if not sessions:
        raise InputError(
            f"{', '.join(str(path) for path in paths)}: expected session tables "
            f"sub-*/beh/*_beh.tsv, found none that can be read"
        )
    register = pd.concat(people, ignore_index=True)
    studies = _studies(_told_apart(_uncopied(sessions)))
    return [
        replace(
            study,
            participants=_present(register, study),
            stimuli=stimuli,
            doubts=tuple(doubtful_names(study.trials, _place(study))),
        )
        for study in studies
    ], notes


def _place(study: Study) -> str:
    """Where the records of a study lie: its one table, or its name."""
    return str(study.sessions[0].path) if len(study.sessions) == 1 else study.name


def _uncopied(sessions: list[Session]) -> list[Session]:
    """The sessions without runs and people that are copies of others of the same study."""
    kinds: dict[tuple[str, str, str | None], list[int]] = {}
    for number, session in enumerate(sessions):
        key = (_plain(session.name), session.task, session.kept_apart)
        kinds.setdefault(key, []).append(number)
    kept: list[Session | None] = list(sessions)
    for members in kinds.values():
        units = [
            unit
            for number in members
            for unit in units_of(
                number, str(sessions[number].path), sessions[number].participant,
                sessions[number].trials,
            )
        ]  # fmt: skip
        for copy, original in copies(units):
            told = (
                f"{copy.where}: {copy.person}, {line_ranges(copy.rows.index)} "
                f"({len(copy.rows)}): a copy of {original.person} in {original.where}, "
                f"{line_ranges(original.rows.index)}; counted once"
            )
            held, first = kept[copy.table], kept[original.table]
            if first is not None:
                kept[original.table] = replace(first, remarks=(*first.remarks, told))
            if held is not None:
                held = kept[copy.table] or held
                rest = held.trials.drop(index=copy.rows.index)
                kept[copy.table] = replace(held, trials=rest) if len(rest) else None
    return [session for session in kept if session is not None]


def _tables(path: Path) -> list[Path]:
    if path.is_file():
        return [path]
    found = sorted(
        table
        for kind in _TABLES
        for table in path.rglob(kind)
        if not {"derivatives", "sourcedata"} & set(table.relative_to(path).parts)
        and not table.name.startswith(".")  # what macOS leaves beside a file: ._NAME
    )
    if found:
        return found
    return sorted(
        table
        for kind in ("*.tsv", "*.csv")
        for table in path.glob(kind)
        if table.name != "participants.tsv" and not table.name.startswith(".")
    )


def _participants(path: Path) -> pd.DataFrame:
    """participants.tsv of a data set, as text; empty when there is none."""
    file = path / "participants.tsv"
    if not file.is_file():
        return pd.DataFrame(columns=["participant_id", "home"])
    table, _ = table_of(lines_of(decoded(file.read_bytes(), errors="replace")), "\t", file)
    return table.reset_index(drop=True).assign(home=str(path.resolve()))


def _stimuli(path: Path) -> dict[str, dict[str, Any]]:
    """The manifest entries of the clips shown, copied beside the record, by hash."""
    found = {}
    for file in sorted((path / "stimuli").glob("*.json")) if path.is_dir() else []:
        entry, faults = read_object(file)
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
        _renamed(session, f"{session.participant}@{_home(session.path).name}")
        if len(homes[_plain(session.name), session.participant]) > 1
        else session
        for session in sessions
    ]


def _renamed(session: Session, name: str) -> Session:
    people = tuple(name if who == session.participant else who for who in session.people)
    return replace(session, participant=name, people=people)


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
