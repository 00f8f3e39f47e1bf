"""Reading a protocol: its keys, what its task demands of it, every fault reported at once."""

import re
import tomllib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from stimuli.errors import InputError
from study.protocol.faults import Fault, faults, one_of, tell_faults
from study.protocol.protocol import Protocol, document_hash, protocol_text
from study.protocol.remarks import tell_remarks
from study.trials.tasks import TASKS


def load_protocol(name_or_path: str | Path) -> Protocol:
    """Read a protocol from a file, or a shipped one by its name.

    Raises InputError that lists every fault, a line each.
    """
    path, text = protocol_text(name_or_path)
    return replace(parse_protocol(text, where=str(path)), where=str(name_or_path))


def parse_protocol(text: str, where: str = "protocol") -> Protocol:
    """A protocol from the text of a TOML file; `where` names it in messages."""
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        line = re.search(r"at line (\d+)", str(error))
        place = f"{where}:{line[1]}" if line else where
        raise InputError(f"{place}: expected TOML, found a syntax error: {error}") from error
    found = faults_of(document)
    if found:
        raise InputError(tell_faults(found, text, where))
    tell_remarks(document, text, where)
    return protocol_of(document)


def faults_of(document: Mapping[str, Any]) -> list[Fault]:
    """Every fault of a parsed protocol, those of its task among them."""
    named = document.get("task")
    task = TASKS.get(named) if isinstance(named, str) else None
    files = {name: known.file for name, known in TASKS.items()}
    if task is None:
        unknown = [] if named is None else [Fault(("task",), one_of(named, tuple(TASKS)))]
        return [*unknown, *faults(document, "", files, lambda document: iter(()))]
    return faults(document, task.name, files, task.faults)


def protocol_of(document: Mapping[str, Any]) -> Protocol:
    """A protocol from a parsed document that has no faults, as records keep it."""
    file = TASKS[document["task"]].file.model_validate(document)
    return Protocol(file, document, document_hash(document))
