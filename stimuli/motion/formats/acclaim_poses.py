"""Reading Acclaim poses (AMC): frame numbers, and below each a line of numbers for every bone.

A file whose frames all list the same bones in the same order, as nearly all do, is read as one
table. What is in the way of that is read line by line, which also names whatever is wrong.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np

from stimuli.errors import InputError
from stimuli.motion.formats.acclaim_skeleton import REMEDY, AcclaimSkeleton
from stimuli.motion.formats.numbers import parse_numbers
from stimuli.motion.formats.source import fault, shown
from stimuli.motion.formats.words import IN_BOUNDS, decimals, whole_number, without_comment
from stimuli.motion.quaternions import Array

_FIRST_FRAME = re.compile(r"^([0-9]+)[ \t]*\r?$", re.MULTILINE)
_FIRST_WORD = re.compile(r"^[ \t]*([A-Za-z_]\S*)", re.MULTILINE)
_LINE = re.compile(r"[^\n]+")
_NEWLINE, _SPACE = np.frombuffer(b"\n ", dtype=np.uint8)
_UNITS = {":DEGREES": True, ":RADIANS": False}


@dataclass(frozen=True, eq=False)
class Poses:
    """Values (F, width) of each bone that an AMC names, and whether its angles are in degrees."""

    values: Mapping[str, Array]
    degrees: bool


def read_poses(path: Path, text: str, skeleton: AcclaimSkeleton) -> Poses:
    """All poses; every frame must name the same bones, frames must count on by one."""
    text, widths = _spelled(text, skeleton), widths_of(skeleton)
    poses = _as_table(path, text, widths, skeleton.degrees)
    return poses or _line_by_line(path, text, widths, skeleton.degrees)


def widths_of(skeleton: AcclaimSkeleton) -> dict[str, int]:
    """How many numbers each bone has in a frame."""
    return {bone.name: len(bone.freedoms) for bone in skeleton.bones}


def _spelled(text: str, skeleton: AcclaimSkeleton) -> str:
    """The text with its bones spelled as the skeleton has them, going by its first frame."""
    names = {bone.name for bone in skeleton.bones}
    frames = [frame.start() for frame in islice(_FIRST_FRAME.finditer(text), 2)]
    for word in dict.fromkeys(_FIRST_WORD.findall(text, 0, *frames[1:])):
        bone = None if word in names else skeleton.bone(word)
        if bone is not None:
            text = re.sub(rf"^(\s*){re.escape(word)}(?=\s)", rf"\g<1>{bone.name}", text, flags=re.M)
    return text


def _as_table(path: Path, text: str, widths: Mapping[str, int], degrees: bool) -> Poses | None:
    """The poses of a file whose frames are all laid out as the first; None of any other."""
    first = _FIRST_FRAME.search(text)
    number = whole_number(first[1]) if first else None
    if first is None or number is None or not text.isascii():
        return None
    for words in map(str.split, text[: first.start()].split("\n")):
        if words and not words[0].startswith(("#", ":")):
            return None
        degrees = _UNITS.get(words[0].upper(), degrees) if words else degrees
    layout = _layout(text, first.end(), widths)
    numbers = _blanked(text, first.start(), number, layout) if layout else None
    if not layout or numbers is None:
        return None
    try:
        table = parse_numbers(path, numbers)
    except InputError:
        return None
    columns = np.cumsum([1, *layout.values()])
    _, *values = np.split(table.reshape(-1, columns[-1]), columns[:-1], axis=1)
    return Poses(dict(zip(layout, values, strict=True)), degrees)


def _layout(text: str, start: int, widths: Mapping[str, int]) -> dict[str, int] | None:
    """The bones of the frame whose lines begin at `start`, in their order, with their widths."""
    layout: dict[str, int] = {}
    for words in (line[0].split() for line in _LINE.finditer(text, start)):
        if len(words) == 1 and whole_number(words[0]) is not None:
            break
        if words and (words[0] not in widths or words[0].startswith(("#", ":"))):
            return None
        if words:
            layout[words[0]] = widths[words[0]]
    return layout


def _blanked(text: str, start: int, first: int, layout: Mapping[str, int]) -> bytes | None:
    """The frames from `start` on with blanks for the bones' names; None when not as laid out.

    What is left are numbers: for each frame its own and, line by line, as many as there should be.
    """
    data = bytearray(text.rstrip(), "ascii")
    data += b"\n" + b" " * max(map(len, layout))  # room for a name at the end of the last line
    codes = np.frombuffer(data, dtype=np.uint8)  # a view, through which names are blanked
    codes[:start] = _SPACE
    ends = np.flatnonzero(codes == _NEWLINE)
    if len(ends) % (1 + len(layout)):
        return None
    starts = np.concatenate([[start], ends[:-1] + 1])
    frames = np.stack([starts, ends], axis=-1).reshape(-1, 1 + len(layout), 2)
    for number, (begin, end) in enumerate(frames[:, 0].tolist(), start=first):
        if text[begin:end].strip() != f"{number}":
            return None
    for begins, name in zip(frames[:, 1:, 0].T, layout, strict=True):
        letters = begins[:, None] + np.arange(len(name))
        spelled = np.frombuffer(name.encode(), dtype=np.uint8)
        if np.any(codes[letters] != spelled) or np.any(codes[begins + len(name)] > _SPACE):
            return None
        codes[letters] = _SPACE
    inside = codes > _SPACE
    words = np.flatnonzero(inside[:-1] > inside[1:])  # where each ends
    counts = np.tile([1, *layout.values()], len(frames))
    lines = np.repeat(np.arange(len(ends)), counts)
    if len(words) != len(lines) or np.any((words < starts[lines]) | (words > ends[lines])):
        return None
    return bytes(data)


def _line_by_line(path: Path, text: str, widths: Mapping[str, int], degrees: bool) -> Poses:
    rows: dict[str, list[list[float]]] = {}
    frame, frames = None, 0
    for number, raw in enumerate(text.split("\n"), start=1):
        words = without_comment(raw).split()
        if not words:
            continue
        if words[0].startswith(":"):
            degrees = _UNITS.get(words[0].upper(), degrees)
        elif len(words) == 1 and words[0][0].isdigit():
            if frame is not None:
                _check_frame(path, rows, frames, number)
            frame, frames = _next_frame(path, words[0], frame, number), frames + 1
        elif frame is None:
            raise fault(path, "a frame number", shown(raw), REMEDY, number)
        else:
            _add_row(path, rows, widths, words, number)
    if frame is None:
        raise fault(path, "frames", "none", REMEDY)
    _check_frame(path, rows, frames, None)
    return Poses({name: np.array(values) for name, values in rows.items()}, degrees)


def _next_frame(path: Path, word: str, last: int | None, line: int) -> int:
    """The number of a frame, which must follow the last one's."""
    frame = whole_number(word)
    if frame is None or (last is not None and frame != last + 1):
        wanted = "a frame number" if last is None else f"frame {last + 1}"
        raise fault(path, wanted, f"frame {shown(word)}", REMEDY, line)
    return frame


def _add_row(
    path: Path,
    rows: dict[str, list[list[float]]],
    widths: Mapping[str, int],
    words: list[str],
    line: int,
) -> None:
    """The values of one bone in one frame."""
    name = words[0]
    if name not in widths:
        raise fault(path, "a bone of the ASF", shown(name), "Use the ASF of this performer.", line)
    values = decimals(words[1:])
    if values is None or len(values) != widths[name]:
        wanted = f"{widths[name]} numbers for {name}, {IN_BOUNDS}"
        raise fault(path, wanted, shown(" ".join(words), 60), REMEDY, line)
    rows.setdefault(name, []).append(values)


def _check_frame(
    path: Path, rows: dict[str, list[list[float]]], frames: int, line: int | None
) -> None:
    """InputError unless every bone has as many rows as there are frames."""
    if not rows or any(len(values) != frames for values in rows.values()):
        odd = next((name for name, values in rows.items() if len(values) != frames), "all bones")
        raise fault(path, "every bone once in each frame", f"{odd} missing or twice", REMEDY, line)
