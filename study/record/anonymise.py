"""A copy of a data set in which nobody is known: new ids, no free text, no time of day.

Copied is what Segue writes, and of that what is named here; whatever else lies in a data set may
name people, so it is left out and told. The original is read only.
"""

import csv
import io
import json
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np

from stimuli.errors import InputError
from stimuli.files import write_atomic
from study.record.copies import files_of, made_from
from study.record.dataset import enrolled
from study.record.people import PARTICIPANT_COLUMNS, QUESTIONS
from study.record.table import COMMON, MISSING, as_number
from study.trials.tasks import TASKS

ROW = {*COMMON, *(name for task in TASKS.values() for name in task.columns)}
PERSON = ("participant_id", *QUESTIONS, "observer")
SIDECAR = {
    "TaskName", "TaskDescription", "Instructions", "InstitutionName", "InstitutionAddress",
    "InstitutionalDepartmentName", "Protocol", "ProtocolHash", "StimulusSetHash",
    "ReferenceLengths", "Seed", "Group", "Observer", "Pace", "Rehearsal", "Finished", "Display",
    "SoftwareVersions", "ResumedOn", "KeyTiming", "TooSlow", "Tracks", "Practice", "Catch",
    "Battery",
}  # fmt: skip
TIMES = {"FirstFlip", "Consent"}  # times of day: the one is left out, of the other that it was
WALL_TIME, SESSION_TIME = "unix_time", "session_time"  # seconds since 1970, since the first flip
WHOLE = ("dataset_description.json", "README", "README.md", "LICENSE", "CHANGES", "stimuli/*.json")
_PLACED = re.compile(r"(?:sourcedata/)?sub-(?P<id>[^/_]+)/.*")


@dataclass
class Anonymised:
    """What came of it: where the copy lies, how many people it has, what was left out and why."""

    folder: Path
    people: int
    left_out: list[str] = field(default_factory=list)


def anonymise(data: Path, out: Path, generator: np.random.Generator) -> Anonymised:
    """Copy a data set to the folder `out`, which must not exist, with ids drawn anew.

    People are p001 on in an order drawn; ages, sexes and yes or no stay, other words about people
    go. Onsets and response times stay. Raises InputError where `data` is none or `out` is there.
    """
    with made_from(data, out, "--out") as folder:
        names = new_names(data, generator)
        made = Anonymised(folder, len(names))
        for place in files_of(data):
            _copy(data / place, place, names, made)
        _participants(data, names, made)
    return Anonymised(out, made.people, made.left_out)


def new_names(data: Path, generator: np.random.Generator) -> dict[str, str]:
    """A new id of each person of a data set, by the old one; numbers in an order drawn."""
    placed = (p for top in (data, data / "sourcedata") for p in top.glob("sub-*") if p.is_dir())
    old = {path.name for path in placed} | set(enrolled(data)[1])
    people = sorted(name.removeprefix("sub-") for name in old)
    digits = max(3, len(str(len(people))))
    numbers = generator.permutation(len(people)) + 1
    return {name: f"p{number:0{digits}d}" for name, number in zip(people, numbers, strict=True)}


def _copy(path: Path, place: str, names: Mapping[str, str], made: Anonymised) -> None:
    """One file of the data set, as its kind is copied; or told that it is not."""
    if _is(place, ("participants.tsv", "participants.json", "derivatives/*")):  # made anew
        return
    if _is(place, WHOLE):
        told = path.read_text(encoding="utf-8")
        write_atomic(made.folder / place, _without_names(told, names))
        return
    found = _PLACED.fullmatch(place)
    copy = next((copy for kind, copy in _COPIES.items() if fnmatchcase(path.name, kind)), None)
    if found is None or copy is None:
        made.left_out.append(f"{place}: Segue did not write it, and it may name people")
        return
    old, new = found["id"], names[found["id"]]
    renamed = re.sub(rf"(?<![A-Za-z0-9])sub-{re.escape(old)}(?=[_/])", f"sub-{new}", place)
    content, lost = copy(path)
    made.left_out += [f"{renamed}: {what}" for what in lost]
    write_atomic(made.folder / renamed, _without_names(content, names))


def _is(place: str, kinds: Iterable[str]) -> bool:
    return any(fnmatchcase(place, kind) for kind in kinds)


def _without_names(text: str, names: Mapping[str, str]) -> str:
    """A text in which people stand under their new ids, wherever BIDS would name them."""
    return re.sub(
        r"sub-([A-Za-z0-9]+)",
        lambda found: f"sub-{names[found[1]]}" if found[1] in names else found[0],
        text,
    )


def _record(path: Path) -> tuple[str, list[str]]:
    """A record's table, its columns those that Segue writes."""
    columns, rows = _read(path)
    kept = [name for name in columns if name in ROW]
    return _written(kept, rows), _lost_columns(columns, kept)


def _sidecar(path: Path) -> tuple[str, list[str]]:
    """A sidecar without times of day; of a consent it is kept that it was given."""
    held = _read_json(path)
    kept = {key: value for key, value in held.items() if key in SIDECAR or key in ROW}
    if "Consent" in held:
        kept["Consent"] = "given"
    lost = [f"{key}, which Segue did not write" for key in held if key not in {*kept, *TIMES}]
    return _json_text(kept), lost


def _flips(path: Path) -> tuple[str, list[str]]:
    """A log of flips, whose times of day become seconds since the first of the session."""
    columns, rows = _read(path)
    if WALL_TIME in columns:
        first = _first_flip(path, rows)
        for row in rows:
            when = as_number(row.get(WALL_TIME))
            row[WALL_TIME] = MISSING if when is None else f"{when - first:.6f}"
    names = {WALL_TIME: SESSION_TIME}
    renamed = [{names.get(key, key): value for key, value in row.items()} for row in rows]
    return _written([names.get(name, name) for name in columns], renamed), []


def _first_flip(path: Path, rows: list[dict[str, str]]) -> float:
    """When a session began: as its sidecar says, else with the first flip of the log."""
    folder = next(p for p in path.parents if p.name == "sourcedata").parent
    beside = path.relative_to(folder / "sourcedata").with_name(
        path.name.replace("_flips.tsv", "_beh.json")
    )
    told = folder / beside
    if told.is_file() and "FirstFlip" in (held := _read_json(told)):
        return float(held["FirstFlip"])
    return next((t for row in rows if (t := as_number(row.get(WALL_TIME))) is not None), 0.0)


def _battery(path: Path) -> tuple[str, list[str]]:
    """The order of a battery."""
    held = _read_json(path)
    return _json_text({key: held[key] for key in ("order", "finished") if key in held}), []


_COPIES: Mapping[str, Callable[[Path], tuple[str, list[str]]]] = {
    "sub-*_beh.tsv": _record,
    "sub-*_beh.json": _sidecar,
    "sub-*_flips.tsv": _flips,
    "battery_*.json": _battery,
}


def _participants(data: Path, names: Mapping[str, str], made: Anonymised) -> None:
    """participants.tsv by new id, each detail only where it is an answer that was asked for."""
    columns, people = enrolled(data)
    if columns:
        rows = []
        for old, row in people.items():
            plain = {name: QUESTIONS[name].plain(row.get(name) or "") for name in QUESTIONS}
            words = {name: text for name, text in plain.items() if text is not None}
            who = f"sub-{names[old.removeprefix('sub-')]}"
            observer = row.get("observer")
            told = observer if observer in ("human", "simulated") else MISSING
            rows.append({"participant_id": who, **words, "observer": told})
        rows.sort(key=lambda row: row["participant_id"])
        write_atomic(made.folder / "participants.tsv", _written(list(PERSON), rows))
        made.left_out += [f"participants.tsv: {what}" for what in _lost_columns(columns, PERSON)]
    told_columns = {name: {"Description": PARTICIPANT_COLUMNS[name]} for name in PERSON}
    write_atomic(made.folder / "participants.json", _json_text(told_columns))


def _lost_columns(columns: Iterable[str], kept: Iterable[str]) -> list[str]:
    return [f"column {name}" for name in columns if name not in set(kept)]


def _read(path: Path) -> tuple[list[str], list[dict[str, str]]]:
    with path.open(encoding="utf-8-sig", newline="") as stream:
        reader = csv.DictReader(stream, delimiter="\t", restval=MISSING)
        rows = [{key: cell for key, cell in row.items() if key is not None} for row in reader]
        return list(reader.fieldnames or ()), rows


def _read_json(path: Path) -> dict[str, Any]:
    try:
        held = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise InputError(f"{path}: expected JSON, found {error}; mend it or move it away") from None
    return held if isinstance(held, dict) else {}


def _written(columns: list[str], rows: Iterable[Mapping[str, str]]) -> str:
    buffer = io.StringIO()
    writer = csv.DictWriter(
        buffer, columns, restval=MISSING, delimiter="\t", lineterminator="\n", extrasaction="ignore"
    )
    writer.writeheader()
    writer.writerows(rows)
    return buffer.getvalue()


def _json_text(document: Mapping[str, Any]) -> str:
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"
