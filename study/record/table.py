"""The record of one session: rows appended, flushed and synced before the next trial starts.

A record is a BIDS behavioural file, `sub-<ID>_task-<label>_run-<N>_beh.tsv`, and a sidecar with
what is needed to replay it. Nothing that was answered is lost by a kill at any moment.
"""

import csv
import io
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from stimuli.errors import InputError, MachineError
from stimuli.files import write_atomic

MISSING = "n/a"

COMMON: Mapping[str, str] = {
    "trial": "number of the trial in the session, from 1",
    "phase": "practice, main or catch",
    "repeat_of": "number of the void trial that this one repeats",
    "onset": "seconds from the session's first flip to the trial's first frame",
    "response": "the answer given",
    "response_time": "seconds from the flip of the trial's last frame to the key",
    "late_frames": "frames shown more than half a screen refresh after they were due",
    "void": "1 when the trial was shown too late to count, else 0",
    "replays": "how often the trial was shown again at the participant's wish",
    "clip_a": "hash of the first clip named by the task",
    "clip_b": "hash of the second clip named by the task",
}

FORMATS: Mapping[str, Mapping[str, str]] = {  # of columns that BIDS knows, and of other numbers
    "onset": {"Format": "number", "Units": "s"},
    "response_time": {"Format": "number", "Units": "s"},
    "trial": {"Format": "integer"},
    "late_frames": {"Format": "integer"},
}


class NotKeptError(MachineError):
    """An answer could not be written; those before it are kept, and resuming asks it again."""


@dataclass
class Record:
    """An open record: its file, its columns, and the sidecar as it stands."""

    path: Path
    columns: tuple[str, ...]
    sidecar: dict[str, Any] = field(default_factory=dict)

    @property
    def sidecar_path(self) -> Path:
        """The JSON file beside the table."""
        return self.path.with_suffix(".json")

    def append(self, row: Mapping[str, object]) -> None:
        """Add one row and sync it to the disk; unknown columns are a fault of the caller."""
        unknown = set(row) - set(self.columns)
        if unknown:
            raise KeyError(f"no such columns: {sorted(unknown)}")
        line = _line([_cell(row.get(column)) for column in self.columns])
        try:
            with self.path.open("a", encoding="utf-8", newline="") as stream:
                stream.write(line)
                stream.flush()
                os.fsync(stream.fileno())
        except OSError as error:
            raise NotKeptError(
                f"{self.path}: trial {row.get('trial')} could not be written: "
                f"{error.strerror or error}"
            ) from error

    def save_sidecar(self, **changes: Any) -> None:
        """Write the sidecar whole, with `changes`."""
        self.sidecar.update(changes)
        write_atomic(
            self.sidecar_path, json.dumps(self.sidecar, indent=2, ensure_ascii=False) + "\n"
        )

    def rows(self) -> list[dict[str, str]]:
        """The rows so far; a last line cut by a kill is taken off and kept beside, in `.torn`."""
        _mend(self.path)
        with self.path.open(encoding="utf-8", newline="") as stream:
            return list(csv.DictReader(stream, delimiter="\t"))


def create(path: Path, columns: tuple[str, ...], sidecar: dict[str, Any]) -> Record:
    """A new record with its header; raises FileExistsError rather than touch an old one.

    The sidecar comes first: a table that is there has one and a header, whenever it is killed.
    """
    if path.exists():
        raise FileExistsError(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    record = Record(path, columns, sidecar)
    record.save_sidecar()
    write_atomic(path, _line(list(columns)))
    return record


def reopen(path: Path) -> Record:
    """An existing record, to go on with."""
    sidecar_path = path.with_suffix(".json")
    try:
        sidecar = json.loads(sidecar_path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(
            f"{sidecar_path}: expected the record's sidecar, found none to read ({error}); "
            "start a new run with --restart"
        ) from error
    with path.open(encoding="utf-8") as stream:
        columns = tuple(stream.readline().rstrip("\n").split("\t"))
    return Record(path, columns, sidecar)


def as_number(text: str | None) -> float | None:
    """A cell as a number; None where it is missing."""
    return None if text in (None, "", MISSING) else float(str(text))


def as_whole(text: str | None) -> int | None:
    """A cell as a whole number; None where it is missing."""
    value = as_number(text)
    return None if value is None else int(value)


def _mend(path: Path) -> None:
    data = path.read_bytes()
    if data and not data.endswith(b"\n"):
        keep = data.rfind(b"\n") + 1
        write_atomic(path.with_suffix(".torn"), data[keep:])
        write_atomic(path, data[:keep])


def _line(cells: list[str]) -> str:
    buffer = io.StringIO()
    csv.writer(buffer, delimiter="\t", lineterminator="\n").writerow(cells)
    return buffer.getvalue()


def _cell(value: object) -> str:
    if value is None:
        return MISSING
    if isinstance(value, bool):
        return str(int(value))
    return f"{value:.6f}" if isinstance(value, float) else str(value)
