"""A battery: several protocols that a person does in one session, their order balanced."""

import tomllib
from importlib import resources
from pathlib import Path
from typing import Annotated

from pydantic import Field, ValidationError

from stimuli.errors import InputError
from study.protocol.protocol import protocol_text
from study.protocol.schema import Count, Name, TomlTable


class Battery(TomlTable):
    """A battery as its TOML file has it: protocols by path or shipped name."""

    name: Name
    title: str = ""
    source: str = ""
    participants: Count = 12
    protocols: Annotated[tuple[str, ...], Field(min_length=2)]


def shipped_batteries() -> dict[str, Path]:
    """The batteries that come with Segue, by name."""
    here = Path(str(resources.files("protocols"))) / "batteries"
    return {path.stem: path for path in sorted(here.glob("*.toml"))}


def battery_of(name_or_path: str) -> Battery | None:
    """The battery that a path or shipped name means; None where it means something else.

    Raises InputError, a line a fault, for a file that lists protocols and is no battery.
    """
    path = Path(name_or_path)
    if not path.is_file():
        path = shipped_batteries().get(name_or_path, path)
    if not path.is_file():
        return None
    try:
        document = tomllib.loads(protocol_text(path)[1])
    except tomllib.TOMLDecodeError:
        return None  # which whoever reads protocols tells
    if "protocols" not in document or "task" in document:
        return None
    try:
        return Battery.model_validate(document)
    except ValidationError as error:
        lines = [
            f"{path}: {'.'.join(map(str, fault['loc']))}: {fault['msg']}, found {fault['input']!r}"
            for fault in error.errors()
        ]
        raise InputError("\n".join(lines)) from error


def orders(members: tuple[str, ...]) -> tuple[tuple[str, ...], ...]:
    """Orders in which each member comes in each place, and follows each other, equally often.

    Williams' square (1949): as many rows as members where these are even, else twice as many.
    """
    count = len(members)
    first = [0]
    for step in range(1, count):
        first.append((first[-1] + (step if step % 2 else -step)) % count)
    rows = [tuple(members[(place + turn) % count] for place in first) for turn in range(count)]
    return tuple(rows if count % 2 == 0 else [*rows, *(row[::-1] for row in rows)])
