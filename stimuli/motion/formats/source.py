"""What every reader returns, and how every reader complains."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from stimuli.errors import InputError
from stimuli.motion.quaternions import Array

MOST_JOINTS = 2_000
LARGEST_NUMBER = 1e9


@dataclass(frozen=True, eq=False)
class Source:
    """A motion as its file has it: the file's units, axes and rate.

    `offsets[0]` is the root's own offset; whether `root` already contains it is `root_absolute`
    to say. `strays` are the joints whose position channels vary, with the largest distance from
    their mean, in file units. `at_rest` marks frames whose root rotation channels are exactly 0.
    """

    format: str
    names: tuple[str, ...]
    parents: np.ndarray
    offsets: Array
    end_parents: np.ndarray
    end_offsets: Array
    rotations: Array
    root: Array
    fps: float
    loop: bool = False
    strays: Mapping[str, float] = field(default_factory=dict)
    at_rest: np.ndarray | None = None
    warnings: tuple[str, ...] = ()


def fault(path: Path, expected: str, found: str, todo: str, line: int | None = None) -> InputError:
    """An InputError in the one form that readers use: where, expected, found, what to do."""
    where = f"{path}:{line}" if line else f"{path}"
    return InputError(f"{where}: expected {expected}, found {found}.\n{todo}")


def shown(text: str, limit: int = 40) -> str:
    """A piece of a file fit for a message: one line, printable, short."""
    clean = "".join(c if c.isprintable() else "?" for c in text.strip())
    return repr(clean if len(clean) <= limit else clean[: limit - 1] + "…")


def decode(path: Path, data: bytes) -> str:
    """The text of a file: UTF-8 or UTF-16 with its mark; refuses what is no text at all."""
    todo = "Export the motion again, or take the original file."
    if not data.strip():
        raise fault(path, "a motion", "an empty file", todo)
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        try:
            return data.decode("utf-16")
        except UnicodeDecodeError:
            raise fault(path, "text", "broken UTF-16", "Save the file as UTF-8.") from None
    head = data[:200].lstrip()
    if head.startswith(b"version https://git-lfs"):
        raise fault(path, "a motion", "a Git LFS pointer", "Run `git lfs pull` where it came from.")
    if head[:1] == b"<":
        raise fault(path, "a motion", "a web page (HTML or XML)", "Download the file itself.")
    if b"\0" in data[:4096]:
        raise fault(path, "text", "binary data", todo)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def rate(path: Path, frame_time: float, line: int | None = None) -> float:
    """Frames a second of a frame time; within 0.1 % of an integer it is that integer."""
    if not 1e-5 <= frame_time <= 1e3:
        raise fault(
            path,
            "a frame time in seconds above 0",
            f"{frame_time:g}",
            "Write the seconds between two frames, such as 0.0333333.",
            line,
        )
    return rounded_rate(1.0 / frame_time)


def rounded_rate(fps: float) -> float:
    """A rate, or the integer that it is within 0.1 % of."""
    whole = round(fps)
    return float(whole) if whole and abs(fps - whole) <= 1e-3 * whole else fps
