"""The BIDS data set around the records: who took part, which runs there are, what was shown."""

import csv
import io
import json
import re
import warnings
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from stimuli.errors import InputError, InputWarning
from stimuli.files import refusals_name, write_atomic
from study.protocol.protocol import Protocol
from study.protocol.schema import Lab
from study.record.people import PARTICIPANT_COLUMNS
from study.record.table import MISSING, Record, reopen

PARTICIPANT = re.compile(r"[A-Za-z0-9]{1,32}")
RUN = re.compile(r"_run-(\d+)_beh\.tsv$")


def check_participant(name: str) -> str:
    """The ID if it is one; others are refused, never rewritten."""
    if not PARTICIPANT.fullmatch(name):
        raise InputError(
            f"participant {name!r}: expected 1 to 32 letters and digits (A-Z, a-z, 0-9); "
            "choose such an ID"
        )
    return name


def check_twin(data: Path, name: str) -> None:
    """Tell an ID from one already there that people, or disks, take for the same.

    IDs that differ by case alone are refused: many disks hold one folder for both. Those that
    differ by leading zeros alone are let through with a warning.
    """
    there = [path.name.removeprefix("sub-") for path in sorted(data.glob("sub-*"))]
    for other in there:
        if other != name and other.casefold() == name.casefold():
            raise InputError(
                f"participant {name!r}: found {other!r} in {data} already, and disks of Windows "
                f"and macOS hold one folder for both; say {other!r} if that is the person, else "
                "choose another ID"
            )
        if other != name and _without_zeros(other) == _without_zeros(name):
            warnings.warn(
                f"participant {name!r} is somebody else than {other!r}, who is in {data} already; "
                f"say {other!r} if that is the person",
                InputWarning,
                stacklevel=2,
            )


def _without_zeros(name: str) -> str:
    return re.sub(r"(?<![0-9])0+(?=[0-9])", "", name.casefold())


README = """Sessions recorded by Segue
==========================

How do people see the transitions between captured human motions? Each table
`sub-*/beh/*_beh.tsv` is one session, a row a trial; its `.json` says what every column means, and
holds the protocol whole. `participants.tsv` has what is known of each person, `stimuli/` what each
clip shows, `sourcedata/` when each frame was flipped. `segue report` reads this folder.
"""


def prepare(data: Path, lab: Lab) -> None:
    """Make `data` a BIDS data set of a lab unless it is one; authors that it lacks are added."""
    description = data / "dataset_description.json"
    held = _json(description)
    content = held or {
        "Name": "Segue sessions",
        "BIDSVersion": "1.10.0",
        "DatasetType": "raw",
        "GeneratedBy": [{"Name": "segue"}],
    }
    told = {"Authors": list(lab.authors), "License": lab.license}
    content = content | {key: value for key, value in told.items() if value and key not in content}
    if content != held and (held or not description.exists()):
        write_atomic(description, json.dumps(content, indent=2, ensure_ascii=False) + "\n")
    if not any(data.glob("README*")):
        write_atomic(data / "README.md", README)
    columns = data / "participants.json"
    if not columns.exists():
        content_columns = {key: {"Description": text} for key, text in PARTICIPANT_COLUMNS.items()}
        write_atomic(columns, json.dumps(content_columns, indent=2) + "\n")


def enrolled(data: Path) -> tuple[list[str], dict[str, dict[str, str]]]:
    """The columns of participants.tsv and its rows by participant; InputError if it is none."""
    path = data / "participants.tsv"
    if not path.exists():
        return [], {}
    try:
        with path.open(encoding="utf-8-sig", newline="") as stream:
            reader = csv.DictReader(stream, delimiter="\t")
            columns = list(reader.fieldnames or ())
            if "participant_id" not in columns:
                raise InputError(
                    f"{path}: expected a column participant_id between tabs, found "
                    f"{', '.join(columns) or 'nothing'}.\nMend the table, or name another --data"
                )
            return columns, {row["participant_id"]: row for row in reader}
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path}: expected UTF-8 text, found {error.reason}.\nSave the table as UTF-8"
        ) from error


def enrol(data: Path, participant: str, **answers: str) -> None:
    """Add a participant to participants.tsv, or fill in what is new about one."""
    path = data / "participants.tsv"
    held, rows = enrolled(data)
    columns = [*PARTICIPANT_COLUMNS, *(name for name in held if name not in PARTICIPANT_COLUMNS)]
    key = f"sub-{participant}"
    new = {name: text for name, text in answers.items() if text}
    rows[key] = {"participant_id": key, **rows.get(key, {}), **new}
    buffer = io.StringIO()
    writer = csv.DictWriter(buffer, columns, restval=MISSING, delimiter="\t", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows.values())
    write_atomic(path, buffer.getvalue())


def record_path(data: Path, participant: str, label: str, run: int) -> Path:
    """Where a participant's run of a task lies."""
    stem = f"sub-{participant}_task-{label}_run-{run}_beh.tsv"
    return data / f"sub-{participant}" / "beh" / stem


def runs(data: Path, participant: str, label: str) -> dict[int, Path]:
    """The runs of a task that a participant has begun, by number."""
    folder = data / f"sub-{participant}" / "beh"
    found = folder.glob(f"sub-{participant}_task-{label}_run-*_beh.tsv")
    return dict(sorted((int(m[1]), path) for path in found if (m := RUN.search(path.name))))


def finished_runs(data: Path, participant: str, label: str, rehearsal: bool) -> list[int]:
    """The numbers of the runs, or of the rehearsals, that a participant has finished."""
    found = []
    for number, path in runs(data, participant, label).items():
        sidecar = _json(path.with_suffix(".json"))  # what cannot be read is not known as finished
        if sidecar.get("Finished") and bool(sidecar.get("Rehearsal")) == rehearsal:
            found.append(number)
    return found


def _json(path: Path) -> dict[str, Any]:
    """A document that is there and can be read; else an empty one."""
    try:
        held = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return held if isinstance(held, dict) else {}


def finished_groups(data: Path, label: str) -> Counter[int]:
    """How many people of each group have finished a task, rehearsals left out."""
    found: Counter[int] = Counter()
    for path in data.glob(f"sub-*/beh/sub-*_task-{label}_run-*_beh.json"):
        sidecar = _json(path)
        if sidecar.get("Finished") and not sidecar.get("Rehearsal"):
            found[int(sidecar.get("Group", 0))] += 1
    return found


def unfinished(data: Path, participant: str, protocol: Protocol, rehearsal: bool) -> Record | None:
    """The participant's latest run of this protocol, unless it is finished.

    Earlier runs were left on purpose when a later one was begun.
    """
    for path in reversed(runs(data, participant, protocol.label).values()):
        record = reopen(path)
        if bool(record.sidecar.get("Rehearsal")) == rehearsal:
            return None if record.sidecar.get("Finished") else record
    return None


def keep_stimulus(data: Path, digest: str, entry: Mapping[str, Any]) -> None:
    """Copy the manifest entry of a clip that is shown into `stimuli/`, once."""
    path = data / "stimuli" / f"{digest}.json"
    if not path.exists():
        write_atomic(path, json.dumps(entry, indent=2, ensure_ascii=False) + "\n")


def source_folder(data: Path, participant: str) -> Path:
    """Where flip logs and locks of a participant lie."""
    folder = data / "sourcedata" / f"sub-{participant}" / "beh"
    with refusals_name(folder):
        folder.mkdir(parents=True, exist_ok=True)
    return folder
