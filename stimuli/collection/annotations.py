"""What is done in which frames of a clip: `annotations.csv` beside it, else the words of its name.

A row is `clip,from_frame,to_frame,label`, both frames included, 0-based at 30 a second.
"""

import csv
import re
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from stimuli.errors import InputError
from stimuli.motion.clip import Clip
from stimuli.motion.formats.words import whole_number

ANNOTATIONS = "annotations.csv"
_COLUMNS = ("clip", "from_frame", "to_frame", "label")
_WORD = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")


class Span(NamedTuple):
    """Frames `first` to `last` of a clip, both included, in which `label` is done."""

    first: int
    last: int
    label: str


def annotated(clip: Clip, frames: int) -> tuple[Span, ...]:
    """The spans of a clip: of the table beside it, else the words of its name over all frames."""
    table = clip.path.parent / ANNOTATIONS
    if table.is_file():
        spans = spans_of(table)
        if clip.name in spans:
            return spans[clip.name]
    return tuple(Span(0, frames - 1, word) for word in words_of(clip.name))


def words_of(name: str) -> tuple[str, ...]:
    """The words of a clip's name in small letters: walk, turn, left of B9_WalkToTurnLeft90."""
    words = (word.lower() for word in _WORD.findall(name))
    return tuple(dict.fromkeys(word for word in words if len(word) > 2))


@lru_cache(maxsize=16)
def spans_of(table: Path) -> Mapping[str, tuple[Span, ...]]:
    """The spans of each clip in a table; InputError with all faults at once, each with its line."""
    with table.open(encoding="utf-8-sig", newline="") as stream:
        lines = list(csv.reader(stream))
    head = [word.strip() for word in lines[0]] if lines else []
    if missing := [name for name in _COLUMNS if name not in head]:
        raise InputError(
            f"{table}:1: expected the columns {','.join(_COLUMNS)}, found no {', '.join(missing)}."
        )
    found: dict[str, list[Span]] = {}
    faults = []
    for number, line in enumerate(lines[1:], start=2):
        row = dict(zip(head, (word.strip() for word in line), strict=False))
        if not any(row.values()):
            continue
        if wrong := next(_wrong(row), None):
            faults.append(f"{table}:{number}: {wrong}")
        else:
            first, last = int(row["from_frame"]), int(row["to_frame"])
            found.setdefault(row["clip"], []).append(Span(first, last, row["label"].lower()))
    if faults:
        raise InputError("\n".join(faults))
    return MappingProxyType({clip: tuple(spans) for clip, spans in found.items()})


def _wrong(row: Mapping[str, str]) -> Iterator[str]:
    numbers = {}
    for key in ("from_frame", "to_frame"):
        value = row.get(key, "")
        numbers[key] = whole_number(value)
        if numbers[key] is None:
            yield f"{key}: expected a frame, 0 or more, found {value!r}"
    first, last = numbers.get("from_frame"), numbers.get("to_frame")
    if first is not None and last is not None and last < first:
        yield f"to_frame: expected {first} or more, found {last}"
    for key in ("clip", "label"):
        if not row.get(key):
            yield f"{key}: expected a name, found nothing"
