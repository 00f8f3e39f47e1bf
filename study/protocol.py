"""Protocols: a study whole, read from one TOML file, every fault reported at once."""

import hashlib
import json
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib import resources
from pathlib import Path
from typing import Any

from stimuli.errors import InputError
from study.faults import faults, render
from study.schema import ProtocolFile


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


def load(name_or_path: str | Path) -> Protocol:
    """Read a protocol from a file, or a shipped one by its name.

    Raises InputError that lists every fault, a line each.
    """
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
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: expected UTF-8 text, found {error.reason}") from error
    return replace(parse(text, where=str(path)), where=str(name_or_path))


def parse(text: str, where: str = "protocol") -> Protocol:
    """A protocol from the text of a TOML file; `where` names it in messages."""
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        line = re.search(r"at line (\d+)", str(error))
        place = f"{where}:{line[1]}" if line else where
        raise InputError(f"{place}: expected TOML, found a syntax error: {error}") from error
    found = faults(document)
    if found:
        raise InputError(render(found, text, where))
    return from_document(document)


def from_document(document: Mapping[str, Any]) -> Protocol:
    """A protocol from a parsed document that has no faults, as records keep it."""
    canonical = json.dumps(document, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    digest = hashlib.sha256(canonical.encode()).hexdigest()
    return Protocol(ProtocolFile.model_validate(document), document, digest)
