"""What a data set holds, in the words of repositories: its studies, columns, files."""

import csv
import json
from collections.abc import Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from study.record.copies import files_of
from study.record.dataset import enrolled
from study.record.people import PARTICIPANT_COLUMNS
from study.record.table import MISSING

KEYWORDS = ("psychophysics", "motion capture", "motion transitions")
KINDS_OF_FILE: Mapping[str, str] = {  # the first that fits
    "sub-*_beh.tsv": "trials of one session, a row a trial",
    "sub-*_beh.json": "what the columns of a session's table mean, its protocol whole, its seed",
    "sourcedata/*_flips.tsv": "what clip frame each refresh showed, and when (seconds)",
    "sourcedata/*battery_*.json": "in which order a person did the protocols of a battery",
    "participants.tsv": "what is known of each person",
    "participants.json": "what the columns of participants.tsv mean",
    "stimuli/*.json": "what a clip shows: its motions, blend and hash",
    "dataset_description.json": "the data set, as BIDS describes one",
    "README*": "what lies where",
    "LICENSE*": "the licence",
    "CHANGES*": "what changed between versions",
    "derivatives/*": "what was made of the data: reports, their tables and figures",
}
FORMATS_OF_FILE: Mapping[str, str] = {
    ".tsv": "text/tab-separated-values", ".csv": "text/csv", ".json": "application/json",
    ".md": "text/markdown", ".html": "text/html", ".svg": "image/svg+xml", ".png": "image/png",
    ".txt": "text/plain",
}  # fmt: skip


@dataclass(frozen=True)
class Contents:
    """A data set: its files, who made it, the sidecars of its sessions by their tables' place."""

    data: Path
    files: tuple[str, ...]
    document: Mapping[str, Any]
    sidecars: Mapping[str, Mapping[str, Any]]
    people: int

    @property
    def name(self) -> str:
        """What the data set is called."""
        return str(self.document.get("Name", "Segue sessions"))

    @property
    def protocols(self) -> dict[str, Mapping[str, Any]]:
        """The protocols of the sessions by hash."""
        held = self.sidecars.values()
        return {str(s["ProtocolHash"]): s["Protocol"] for s in held if "ProtocolHash" in s}

    @property
    def description(self) -> str:
        """The studies in a sentence."""
        told = [
            f"{p.get('title') or p.get('name')}" + (f" (after {p['source']})" if p.get("source")
            else "") for p in self.protocols.values()
        ]  # fmt: skip
        people = "1 person" if self.people == 1 else f"{self.people} people"
        what = "; ".join(dict.fromkeys(told)) or "transitions between captured human motions"
        sessions = len(self.sidecars)
        return f"{sessions} session{'s' * (sessions != 1)} of {people}: {what}."

    @property
    def columns(self) -> dict[str, dict[str, str]]:
        """What each column of a session's table means, as sidecars have it."""
        return {
            name: told
            for sidecar in self.sidecars.values()
            for name, told in sidecar.items()
            if isinstance(told, dict) and isinstance(told.get("Description"), str)
        }

    @property
    def personal(self) -> list[str]:
        """What is in it that tells who somebody was, beyond an id."""
        _, rows = enrolled(self.data)
        found = []
        if any(row.get("comments") not in (None, "", MISSING) for row in rows.values()):
            found.append("comments")
        if set(next(iter(rows.values()), {})) - set(PARTICIPANT_COLUMNS):
            found.append("columns that Segue did not write")
        if any("FirstFlip" in sidecar for sidecar in self.sidecars.values()):
            found.append("times of day")
        return found


def contents_of(data: Path) -> Contents:
    """Look through a data set."""
    files = tuple(files_of(data))
    tables = [place for place in files if fnmatchcase(place, "sub-*_beh.tsv")]
    sidecars = {place: _object((data / place).with_suffix(".json")) for place in tables}
    _, rows = enrolled(data)
    people = len(rows) or len({place.split("/")[0] for place in tables})
    return Contents(data, files, _object(data / "dataset_description.json"), sidecars, people)


def told_of_file(place: str) -> str:
    """What a file of a data set is, in words."""
    kinds = (told for kind, told in KINDS_OF_FILE.items() if fnmatchcase(place, kind))
    return next(kinds, "put there by the lab")


def format_of(place: str) -> str:
    """The media type of a file."""
    return FORMATS_OF_FILE.get(Path(place).suffix.lower(), "application/octet-stream")


def cells(path: Path) -> list[list[str]]:
    """The rows of a table between tabs, its header the first."""
    with path.open(encoding="utf-8-sig", newline="") as stream:
        return list(csv.reader(stream, delimiter="\t"))


def _object(path: Path) -> dict[str, Any]:
    try:
        held = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return held if isinstance(held, dict) else {}
