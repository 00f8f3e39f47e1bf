"""Reading BVH, of any exporter: a stream of words, whose numbers are read in one pass.

Position channels replace OFFSET, as Blender, MotionBuilder and Maya do. Euler angles apply in
the order of a joint's own channels, intrinsically.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stimuli.motion.formats.bvh_hierarchy import Hierarchy, read_hierarchy
from stimuli.motion.formats.bvh_table import BvhFrames, read_bvh_frames
from stimuli.motion.formats.rates import written_rate
from stimuli.motion.formats.source import (
    Take,
    decoded,
    fault,
    line_of,
    shown,
    text_bytes,
)
from stimuli.motion.formats.words import decimal, whole_number
from stimuli.motion.quaternions import Array

_SKIPPED = rb"\s*(?:(?:#|//)[^\r\n]*(?:[\r\n]\s*|\Z))*"  # a comment ends with its line alone
_WIDE_BLANKS = re.compile(rb"\xc2\xa0|\xe2\x80[\x80-\x8b\xaf]|\xe3\x80\x80|\xef\xbb\xbf")
_HIERARCHY = re.compile(_SKIPPED + rb"HIERARCHY", re.IGNORECASE)
_MOTION = re.compile(
    rb"(?:^|(?<=[\s}]))MOTION(?=\s)(?=" + _SKIPPED + rb"(?!\{)(Frame)?)", re.IGNORECASE
)
_COMMENTED = re.compile(rb"(?<!\S)(?:#|//)[^\r\n]*\Z")
_FIELDS = {
    "Frames": re.compile(_SKIPPED + rb"(Frames\s*(?::\s*)?)([^\s:]*)", re.IGNORECASE),
    "Frame Time": re.compile(_SKIPPED + rb"(Frame\s*Time\s*(?::\s*)?)(\S*)", re.IGNORECASE),
}
_ADVICE = {
    "Frames": ("Frames: and their number", "Write the number of frames."),
    "Frame Time": (
        "Frame Time: and seconds",
        "Write the seconds between two frames, such as 0.0333333.",
    ),
}


@dataclass(frozen=True)
class _Header:
    """What stands between MOTION and the numbers, which begin at the byte `start`."""

    frames: int
    fps: float
    start: int
    warnings: tuple[str, ...]


def read_bvh(path: Path, data: bytes, fps: float | None = None) -> Take:
    """The motion of a BVH file; `fps` overrides its frame time. InputError when malformed."""
    data = _blanked(text_bytes(path, data))
    if not _HIERARCHY.match(data):
        todo = "This is no BVH file; export it as BVH."
        raise fault(path, "HIERARCHY", shown(_next_line(data, 0)), todo, 1)
    start, end = _motion(data)
    tree = read_hierarchy(path, decoded(data[:start]))
    if start == len(data):
        raise fault(
            path,
            "a line MOTION after the hierarchy",
            "none",
            "The file is cut short, or holds a skeleton alone; export the motion with it.",
        )
    header = _read_header(path, data, end, fps)
    table = read_bvh_frames(path, data, header.start, tree, header.frames, header.fps)
    offsets, moves, notes = _offsets(path, tree, table)
    return Take(
        format="bvh",
        names=tuple(tree.names),
        parents=np.array(tree.parents),
        offsets=offsets,
        end_parents=np.array(tree.end_parents, dtype=int),
        end_offsets=np.array(tree.end_offsets, dtype=float).reshape(-1, 3),
        rotations=table.rotations,
        root=moves.pop(0),
        fps=header.fps,
        moves=moves,
        declared=np.array(tree.offsets, dtype=float),
        at_rest=table.at_rest,
        warnings=(*header.warnings, *table.warnings, *notes),
    )


def _blanked(data: bytes) -> bytes:
    """The bytes of a text with blanks for those that ASCII has not, each as long as it was."""
    if data.isascii():
        return data
    return _WIDE_BLANKS.sub(lambda found: b" " * len(found[0]), decoded(data).encode())


def _motion(data: bytes) -> tuple[int, int]:
    """Where the word MOTION begins and ends: the one before Frames, else the first; else the end.

    A name is no such word, as a brace follows it; nor is one in a comment.
    """
    found = None
    for match in _MOTION.finditer(data):
        line = max(data.rfind(b"\n", 0, match.start()), data.rfind(b"\r", 0, match.start()), 0)
        if _COMMENTED.search(data, line, match.start()):
            continue
        if match[1]:
            return match.start(), match.end()
        found = found or match
    return (found.start(), found.end()) if found else (len(data), len(data))


def _read_header(path: Path, data: bytes, place: int, fps: float | None) -> _Header:
    """The number of frames and the rate, in whichever order they come."""
    words: dict[str, tuple[str, int]] = {}
    for _ in _FIELDS:
        for name, pattern in _FIELDS.items():
            if name not in words and (match := pattern.match(data, place)):
                words[name] = (decoded(match[2]), line_of(data, match.start(1)))
                place = match.end()
    line = line_of(data, re.compile(_SKIPPED).match(data, place).end())  # type: ignore[union-attr]
    for name in _FIELDS:
        word, at = words.get(name, ("", line))
        if (whole_number if name == "Frames" else decimal)(word) is None:
            found = f"{name}: {word}" if name in words else _next_line(data, place)
            raise fault(path, _ADVICE[name][0], shown(found), _ADVICE[name][1], at)
    frames = int(words["Frames"][0])
    if frames < 1:
        raise fault(
            path, "at least one frame", f"{frames}", "Export the motion again.", words["Frames"][1]
        )
    if fps is not None:
        return _Header(frames, fps, place, ())
    found_rate, note = written_rate(path, *words["Frame Time"])
    return _Header(frames, found_rate, place, (note,) if note else ())


def _next_line(data: bytes, place: int) -> str:
    """The first line with anything in it from a place on."""
    return (decoded(data[place : place + 200]).strip().splitlines() or ["the end"])[0]


def _offsets(
    path: Path, tree: Hierarchy, table: BvhFrames
) -> tuple[Array, dict[int, Array], list[str]]:
    """Offsets (J, 3), positions (F, 3) of the root and of joints that have them, and warnings.

    InputError where the positions of all joints are 0, and so would shrink the body to a point.
    """
    offsets = np.array(tree.offsets, dtype=float)
    frames = len(table.rotations)
    moves = {0: np.broadcast_to(offsets[0], (frames, 3))}
    shrunk: list[int] = []
    kept = 0.0
    for joint, axes in table.moving.items():
        values = table.positions[joint]
        if joint == 0:
            moves[0] = _placed(offsets[0], values, axes)
            continue
        still = values.min(axis=0) == values.max(axis=0)
        mean = np.where(still, values[0], values.mean(axis=0))
        if np.any(offsets[joint, axes]) and not np.any(values):
            shrunk.append(joint)
        offsets[joint, axes] = mean
        kept += float(np.abs(mean).sum())
        if len(axes) == 3 or not still.all():
            moves[joint] = _placed(offsets[joint], values, axes)
    names = ", ".join(tree.names[joint] for joint in shrunk[:6])
    if len(shrunk) > 1 and kept == 0:
        raise fault(
            path,
            "positions of joints, which replace their OFFSETs",
            f"0 in all frames for {names}{' …' if len(shrunk) > 6 else ''}",
            "They would shrink the body to a point: export without positions below the root.",
        )
    notes = [f"positions that are 0 replace the OFFSET of {names}"] if shrunk else []
    if not any(len(axes) == 3 for axes in table.moving.values()) and 0 not in table.moving:
        notes.append("the root has no position channels: the body stays in its place")
    return offsets, moves, notes


def _placed(offset: Array, values: Array, axes: list[int]) -> Array:
    """Positions (F, 3) that have `values` (F, N) along some axes and are `offset` along others."""
    if axes == [0, 1, 2]:
        return values
    placed = np.tile(offset, (len(values), 1))
    placed[:, axes] = values
    return placed
