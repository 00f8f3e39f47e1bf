"""What the keys of a demand may hold: one small check for each kind of value."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import isfinite
from typing import Any

ValueCheck = Callable[[Any], str | None]  # what was expected, where a value is not that


@dataclass(frozen=True)
class Field:
    """A key of a table: the check of its value, and what stands in where it may be left out."""

    check: ValueCheck
    needed: bool = True
    default: Any = None


def is_number(value: Any) -> bool:
    """Whether a value is a finite number."""
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)


def frame(value: Any) -> str | None:
    """A frame of a clip, or of the motion wanted."""
    whole = isinstance(value, int) and not isinstance(value, bool) and value >= 0
    return None if whole else "a frame, a whole number from 0"


def moment(value: Any) -> str | None:
    """A frame of the motion wanted, or its last one."""
    return None if value == "end" or frame(value) is None else 'a frame from 0, or "end"'


def number(value: Any) -> str | None:
    """A finite number."""
    return None if is_number(value) else "a number"


def weight(value: Any) -> str | None:
    """How much something counts."""
    return None if is_number(value) and value >= 0 else "a number, 0 or more"


def positive(value: Any) -> str | None:
    """A size."""
    return None if is_number(value) and value > 0 else "a number above 0"


def motion_length(value: Any) -> str | None:
    """How many frames a motion has."""
    return None if frame(value) is None and value >= 2 else "a whole number, 2 or more"


def piece_length(value: Any) -> str | None:
    """How many frames a piece of a clip has at least."""
    return None if frame(value) is None and value >= 1 else "a whole number, 1 or more"


def word(value: Any) -> str | None:
    """A name."""
    return None if isinstance(value, str) and value.strip() else "a name in quotes"


def numbers(size: int, of: str) -> ValueCheck:
    """So many numbers in brackets."""

    def check(value: Any) -> str | None:
        fits = isinstance(value, list) and len(value) == size and all(map(is_number, value))
        return None if fits else of

    return check


_FLOOR = numbers(2, "[x, z] in metres")
_SPACE = numbers(3, "[x, y, z] in metres")
_VELOCITY = numbers(3, "[x, y, z] in metres a second")
KINDS: Mapping[str, Mapping[str, Field]] = {
    "body": {
        "at": Field(moment), "place": Field(_FLOOR), "heading": Field(number),
        "weight": Field(weight, False, 1.0),
    },
    "joint": {
        "at": Field(moment), "role": Field(word), "place": Field(_SPACE),
        "velocity": Field(_VELOCITY, False), "weight": Field(weight, False, 1.0),
    },
    "style": {
        "from": Field(moment), "to": Field(moment), "label": Field(word),
        "weight": Field(weight, False, 1.0),
    },
    "avoid": {
        "centre": Field(_FLOOR, False), "radius": Field(positive, False),
        "low": Field(lambda v: _FLOOR(v) and _SPACE(v) and "[x, z] or [x, y, z] in metres", False),
        "high": Field(lambda v: _FLOOR(v) and _SPACE(v) and "[x, z] or [x, y, z] in metres", False),
        "weight": Field(weight, False, 1.0),
    },
    "pose": {"at": Field(moment), "clip": Field(word), "frame": Field(frame)},
}  # fmt: skip
WEIGHTS_OF: Mapping[str, Field] = {
    name: Field(weight, False, 1.0) for name in ("cuts", "frames", *KINDS) if name != "pose"
}
