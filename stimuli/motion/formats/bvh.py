"""Reading BVH, of any exporter: hierarchy by statements, all numbers in one call.

Position channels replace OFFSET, as Blender, MotionBuilder and Maya do. Euler angles apply in
the order of a joint's own channels, intrinsically.
"""

import re
from pathlib import Path

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.formats.bvh_hierarchy import AXES, Hierarchy, read_hierarchy
from stimuli.motion.formats.numbers import numbers_and_ends, words_in_lines
from stimuli.motion.formats.source import Source, check_size, decode, fault, rate, shown
from stimuli.motion.formats.words import decimal, whole
from stimuli.motion.quaternions import Array

_MOTION = re.compile(r"^[ \t]*MOTION[ \t]*\r?$", re.MULTILINE | re.IGNORECASE)
_FRAMES = re.compile(r"\s*Frames\s*:\s*(\S*)", re.IGNORECASE)
_AT_ONCE = 200_000  # rotations made in one go, which takes some ten times their own memory
_FRAME_TIME = re.compile(r"\s*Frame\s*Time\s*:[ \t]*(\S*)", re.IGNORECASE)


def read_bvh(path: Path, data: bytes, fps: float | None = None) -> Source:
    """The motion of a BVH file; `fps` overrides its frame time. InputError when malformed."""
    text = decode(path, data)
    start = _MOTION.search(text)
    if not re.match(r"\s*HIERARCHY", text, re.IGNORECASE):
        raise fault(
            path, "HIERARCHY", shown(text[:40]), "This is no BVH file; export it as BVH.", 1
        )
    if start is None:
        raise fault(
            path,
            "a line MOTION after the hierarchy",
            "none",
            "The file is cut short, or holds a skeleton alone; export the motion with it.",
        )
    hierarchy = read_hierarchy(path, text[: start.start()])
    values, frame_rate, warnings = _read_motion(path, text, start.end(), hierarchy, fps)
    check_size(path, len(values), len(hierarchy.names), frame_rate)
    rotations, root, strays, at_rest = _poses(hierarchy, values)
    return Source(
        format="bvh",
        names=tuple(hierarchy.names),
        parents=np.array(hierarchy.parents),
        offsets=np.array(hierarchy.offsets),
        end_parents=np.array(hierarchy.end_parents, dtype=int),
        end_offsets=np.array(hierarchy.end_offsets).reshape(-1, 3),
        rotations=rotations,
        root=root,
        fps=frame_rate,
        strays=strays,
        at_rest=at_rest,
        warnings=tuple(warnings),
    )


def _read_motion(
    path: Path, text: str, start: int, tree: Hierarchy, fps: float | None
) -> tuple[Array, float, list[str]]:
    """The values (F, C) of all channels, the rate, and warnings."""
    first_line = text.count("\n", 0, start) + 1
    frames_match = _FRAMES.match(text, start)
    expected = whole(frames_match[1]) if frames_match else None
    if frames_match is None or expected is None:
        raise fault(
            path,
            "Frames: and their number",
            _line_after(text, start),
            "Write the number of frames.",
            first_line + 1,
        )
    time_match = _FRAME_TIME.match(text, frames_match.end())
    time_line = text.count("\n", 0, frames_match.end()) + 2
    frame_time = decimal(time_match[1]) if time_match else None
    if time_match is None or frame_time is None:
        raise fault(
            path,
            "Frame Time: and seconds",
            _line_after(text, frames_match.end()),
            "Write the seconds between two frames, such as 0.0333333.",
            time_line,
        )
    body = time_match.end()
    width = sum(len(channels) for channels in tree.channels)
    if expected < 1 or width == 0:
        raise fault(
            path,
            "at least one frame of at least one channel",
            f"{expected} frames of {width} channels",
            "Export the motion again.",
            first_line + 1,
        )
    frame_rate = fps if fps is not None else rate(path, frame_time, time_line)
    numbers, ends = numbers_and_ends(path, text, body)
    in_rows = ends is not None and _end_lines(text, ends[width - 1 : -1 : width])
    values, warnings = _frames(path, text, body, numbers, expected, width, in_rows)
    return values, frame_rate, warnings


def _line_after(text: str, start: int) -> str:
    """The first line with anything in it from `start` on, as messages show it."""
    return shown(text[start : start + 200].strip().partition("\n")[0])


def _end_lines(text: str, ends: np.ndarray) -> bool:
    """Whether the words that end there are the last of their lines, a few blanks apart."""
    return all(text[end : end + 3].lstrip(" \t\r")[:1] == "\n" for end in ends.tolist())


def _frames(
    path: Path, text: str, body: int, numbers: Array, expected: int, width: int, in_rows: bool
) -> tuple[Array, list[str]]:
    """Numbers as (F, C); refuses a table that does not fit, naming its first odd line.

    `in_rows` tells that every frame is known to end where a line does, which spares counting.
    """
    found, rest = divmod(numbers.size, width)
    fits = rest == 0 and found >= expected
    if fits and (in_rows or not _shifted(words_in_lines(text, body), found, width)):
        if found == expected:
            return numbers.reshape(found, width), []
        note = f"the header says {expected} frames, {found} are there: the first {expected} used"
        return numbers[: expected * width].reshape(expected, width), [note]
    line = text.count("\n", 0, body) + 1
    counts = words_in_lines(text, body)
    rows = np.flatnonzero(counts)
    odd = np.flatnonzero(counts[rows] != width)
    if len(odd):
        row = rows[odd[0]]
        raise fault(
            path,
            f"{expected} frames of {width} numbers",
            f"{numbers.size} numbers in all; frame {odd[0] + 1} has {counts[row]}",
            "The file is damaged or cut short; export it again.",
            line + int(row),
        )
    raise fault(
        path,
        f"{expected} frames of {width} numbers",
        f"{found}",
        "The file is cut short, or its Frames: is wrong.",
        line,
    )


def _shifted(counts: np.ndarray, frames: int, width: int) -> bool:
    """Whether there is a line for each frame, and yet not of `width` words each.

    Frames may be wrapped over several lines; here a number has moved into another's line.
    """
    counts = counts[counts > 0]
    return len(counts) == frames and bool(np.any(counts != width))


def _poses(
    tree: Hierarchy, values: Array
) -> tuple[Array, Array, dict[str, float], np.ndarray | None]:
    """Rotations (F, J, 4), root (F, 3), joints whose position varies, frames at rest."""
    frames, joints = len(values), len(tree.names)
    root = np.tile(tree.offsets[0], (frames, 1))
    rotations = np.tile(quat.IDENTITY, (frames, joints, 1))
    strays: dict[str, float] = {}
    by_order: dict[str, tuple[list[int], list[list[int]]]] = {}
    at_rest = None
    column = 0
    for joint, channels in enumerate(tree.channels):
        columns = range(column, column + len(channels))
        column += len(channels)
        turns = [c for c, (kind, _) in zip(columns, channels, strict=True) if kind == "rotation"]
        order = "".join(AXES[axis] for kind, axis in channels if kind == "rotation")
        moves = [
            (c, a) for c, (kind, a) in zip(columns, channels, strict=True) if kind == "position"
        ]
        if order:
            group = by_order.setdefault(order, ([], []))
            group[0].append(joint)
            group[1].append(turns)
            if joint == 0:
                at_rest = np.all(values[:, turns] == 0, axis=1)
        if joint == 0:
            for source, axis in moves:
                root[:, axis] = values[:, source]
        elif moves:
            _place(tree, joint, values, moves, strays)
    step = max(1, _AT_ONCE // joints)
    for order, (members, turns_of) in by_order.items():
        columns_of = np.array(turns_of)
        for some in (slice(first, first + step) for first in range(0, frames, step)):
            angles = np.radians(values[some, columns_of])
            rotations[some, members] = quat.from_euler(angles, order)
    return rotations, root, strays, at_rest


def _place(
    tree: Hierarchy,
    joint: int,
    values: Array,
    moves: list[tuple[int, int]],
    strays: dict[str, float],
) -> None:
    """Position channels of a joint below the root: their mean replaces its OFFSET."""
    columns = [source for source, _ in moves]
    mean = values[:, columns].mean(axis=0)
    tree.offsets[joint] = tree.offsets[joint].copy()
    tree.offsets[joint][[axis for _, axis in moves]] = mean
    stray = float(np.linalg.norm(values[:, columns] - mean, axis=1).max())
    if stray > 0:
        strays[tree.names[joint]] = stray
