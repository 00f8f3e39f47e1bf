"""What every reader returns, and how every reader complains."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from stimuli.errors import InputError
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import depth_first_order

MOST_JOINTS = 2_000
MOST_FRAMES = 2_000_000  # 18 hours at 30 a second, 4 at 120
# Joints times frames: 3 hours of 31 at 30 a second. On the way to a clip they take 1.5 GB, and 3 GB
# when each has six channels, as then the file itself is of such a size.
MOST_ROTATIONS = 12_000_000
SLOWEST, FASTEST = 1.0, 2_000.0  # frames a second of any capture of a whole body
_SAME_RATE = 1e-3  # rates this near, in proportion, are one


@dataclass(frozen=True, eq=False)
class Source:
    """A motion as its file has it: the file's units, axes and rate.

    `offsets[0]` is the root's own offset. `strays` are the joints whose position channels vary,
    with the largest distance from their mean, in file units. `at_rest` marks frames whose root
    rotation channels are exactly 0.
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


def contents(path: Path) -> bytes:
    """The bytes of a file; InputError when it cannot be read."""
    try:
        return path.read_bytes()
    except OSError as error:
        why = error.strerror or "unreadable"
        raise InputError(f"{path}: expected a file to read, found none ({why}).") from None


def is_rate(fps: float) -> bool:
    """Whether frames a second are those of a capture."""
    return SLOWEST * (1 - _SAME_RATE) <= fps <= FASTEST * (1 + _SAME_RATE)


def rate(path: Path, frame_time: float, line: int | None = None) -> float:
    """Frames a second of a frame time; within 0.1 % of an integer it is that integer."""
    if not (frame_time > 0 and is_rate(1.0 / frame_time)):
        raise fault(
            path,
            f"a frame time of {1 / FASTEST:g} to {1 / SLOWEST:g} seconds",
            f"{frame_time:g}",
            "Write the seconds between two frames, such as 0.0333333.",
            line,
        )
    return rounded_rate(1.0 / frame_time)


def rounded_rate(fps: float) -> float:
    """A rate, or the integer that it is within 0.1 % of."""
    whole = round(fps)
    return float(whole) if whole and abs(fps - whole) <= _SAME_RATE * whole else fps


def check_size(path: Path, frames: int, joints: int, fps: float) -> None:
    """InputError when a motion is longer or larger than any capture; to be asked before it is made.

    A wrong rate multiplies the frames, and joints without channels cost a file nothing.
    """
    if frames > MOST_FRAMES or frames * joints > MOST_ROTATIONS:
        raise fault(
            path,
            f"at most {MOST_FRAMES:,} frames and {MOST_ROTATIONS:,} joint rotations",
            f"{frames:,} frames of {joints} joints at {fps:g} a second",
            "Mend the rate where that is wrong, or cut the motion into shorter clips.",
        )


def depth_first(source: Source) -> Source:
    """The same motion with its joints in the order in which BVH lists them."""
    order = depth_first_order(source.parents)
    place = np.argsort(order)
    ends = np.argsort(place[source.end_parents], kind="stable")
    return replace(
        source,
        names=tuple(source.names[joint] for joint in order),
        parents=np.array([-1, *place[source.parents[order[1:]]]]),
        offsets=source.offsets[order],
        end_parents=place[source.end_parents][ends],
        end_offsets=source.end_offsets[ends],
        rotations=source.rotations[:, order],
    )
