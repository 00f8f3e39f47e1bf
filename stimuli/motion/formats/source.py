"""What every reader returns, and how every reader complains."""

import re
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
LINE_END = r"\r{0,2}\n|\r"  # of any system, or of two in turn
_LINE_END = re.compile(LINE_END.encode())
_ANYTHING = re.compile(rb"\S")


@dataclass(frozen=True, eq=False)
class Take:
    """A motion as its file has it: the file's units, axes and rate.

    `offsets[0]` is the root's own offset. `moves` are the positions (F, 3) of joints below the
    root that have all three position channels, or whose positions vary: their offsets are the
    means of these, and `declared` those that the file has for them. `at_rest` marks frames whose
    root is not turned at all. `world` is the up axis where the format has one.
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
    moves: Mapping[int, Array] = field(default_factory=dict)
    declared: Array | None = None
    at_rest: np.ndarray | None = None
    world: str | None = None
    warnings: tuple[str, ...] = ()


def fault(path: Path, expected: str, found: str, todo: str, line: int | None = None) -> InputError:
    """An InputError in the one form that readers use: where, expected, found, what to do."""
    where = f"{path}:{line}" if line else f"{path}"
    return InputError(f"{where}: expected {expected}, found {found}.\n{todo}")


def shown(text: str, limit: int = 40) -> str:
    """A piece of a file fit for a message: one line, printable, short."""
    clean = "".join(c if c.isprintable() else "?" for c in text.strip())
    return repr(clean if len(clean) <= limit else clean[: limit - 1] + "…")


def text_bytes(path: Path, data: bytes) -> bytes:
    """The bytes of a text in one of the encodings that hold ASCII; refuses what is no text."""
    todo = "Export the motion again, or take the original file."
    if not _ANYTHING.search(data):
        raise fault(path, "a motion", "an empty file", todo)
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        try:
            return data.decode("utf-16").encode()
        except UnicodeError:
            raise fault(path, "text", "broken UTF-16", "Save the file as UTF-8.") from None
    head = data[:200].lstrip()
    if head.startswith(b"version https://git-lfs"):
        raise fault(path, "a motion", "a Git LFS pointer", "Run `git lfs pull` where it came from.")
    if head[:1] == b"<":
        raise fault(path, "a motion", "a web page (HTML or XML)", "Download the file itself.")
    if b"\0" in data[:4096]:
        raise fault(path, "text", "binary data", todo)
    return data.removeprefix(b"\xef\xbb\xbf").removesuffix(b"\x1a")  # a mark of DOS at the end


def text_of(path: Path, data: bytes) -> str:
    """The text of a file, lines ending in one way: UTF-8, UTF-16 with its mark, else Latin-1."""
    text = decoded(text_bytes(path, data))
    for end in ("\r\r\n", "\r\n", "\r"):
        text = text.replace(end, "\n")
    return text


def decoded(data: bytes) -> str:
    """The text that bytes are: UTF-8, else Latin-1."""
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def line_of(data: bytes, place: int) -> int:
    """The number of the line in which a byte lies."""
    if data.find(b"\r", 0, place) < 0:
        return 1 + data.count(b"\n", 0, place)
    return 1 + sum(1 for _ in _LINE_END.finditer(data, 0, place))


def contents(path: Path) -> bytes:
    """The bytes of a file; InputError when it cannot be read."""
    try:
        return path.read_bytes()
    except OSError as error:
        why = error.strerror or "unreadable"
        raise InputError(f"{path}: expected a file to read, found none ({why}).") from None


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


def depth_first(take: Take) -> Take:
    """The same motion with its joints in the order in which BVH lists them."""
    order = depth_first_order(take.parents)
    place = np.argsort(order)
    ends = np.argsort(place[take.end_parents], kind="stable")
    return replace(
        take,
        names=tuple(take.names[joint] for joint in order),
        parents=np.array([-1, *place[take.parents[order[1:]]]]),
        offsets=take.offsets[order],
        end_parents=place[take.end_parents][ends],
        end_offsets=take.end_offsets[ends],
        rotations=take.rotations[:, order],
    )
