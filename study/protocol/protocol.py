"""A protocol: a study whole, as one TOML file says it; `study.trials.reading` reads one."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from stimuli.errors import InputError
from study.protocol.schema import ProtocolFile


@dataclass(frozen=True, eq=False)
class Protocol:
    """A checked protocol, the document as written, and the hash that names it."""

    file: ProtocolFile
    document: Mapping[str, Any]
    hash: str
    where: str = ""  # the path or shipped name that it was loaded by

    @property
    def called(self) -> str:
        """What a command line calls it: its path, or the name of a shipped protocol."""
        return self.where or self.file.name

    @property
    def name(self) -> str:
        """The protocol's name, as the record's TaskName has it."""
        return self.file.name

    @property
    def label(self) -> str:
        """The BIDS task label: the name without what is not alphanumeric."""
        return "".join(c for c in self.file.name if c.isalnum())


def shipped() -> dict[str, Path]:
    """The protocols that come with Segue, by name."""
    here = Path(str(resources.files("protocols")))
    return {path.stem: path for path in sorted(here.glob("*.toml"))}


def protocol_text(name_or_path: str | Path) -> tuple[Path, str]:
    """The file that a path or shipped name means, and its text; InputError where none is."""
    path = Path(name_or_path)
    if not path.is_file():
        path = shipped().get(str(name_or_path), path)
    if not path.is_file():
        names = ", ".join(shipped())
        raise InputError(
            f"{name_or_path}: expected a protocol file or one of {names}; found no such file"
        )
    try:
        # Notepad begins a file with a byte order mark, which TOML does not know.
        return path, path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: expected UTF-8 text, found {error.reason}") from error


def document_hash(document: Mapping[str, Any]) -> str:
    """SHA-256 of what a protocol says, however it is written."""
    canonical = json.dumps(document, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    return hashlib.sha256(canonical.encode()).hexdigest()
