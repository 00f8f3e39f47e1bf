"""The frames of a BVH: numbers turned to rotations some frames at a time.

Reading takes memory of three times the file; or, where its numbers have at most one decimal, of the
file and a tenth more than its rotations, 32 bytes for each three numbers, which alone may be
three times such a file.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stimuli.compiled import worth_loading
from stimuli.motion import quaternions as quat
from stimuli.motion.formats.bvh_hierarchy import AXES, Hierarchy
from stimuli.motion.formats.numbers import number_blocks
from stimuli.motion.formats.plain_numbers import plain_blocks
from stimuli.motion.formats.scan_state import (
    LINES,
    ODD_BEGINS,
    ODD_LINE,
    ODD_LINES,
    ODD_WORDS,
    State,
    new_state,
)
from stimuli.motion.formats.source import check_size, fault, line_of
from stimuli.motion.quaternions import Array

_Poses = tuple[int, Array, Array]  # how many are wanted, rotations and positions to be filled
_AT_ONCE = 1_500  # numbers
_USUAL = 8  # bytes of a number: longer ones take longer


@dataclass(frozen=True, eq=False)
class BvhFrames:
    """Rotations (F, J, 4); the position channels (F, N) of joints, by joint, and the axes of these;
    which frames have a root that is not turned."""

    rotations: Array
    positions: dict[int, Array]
    moving: dict[int, list[int]]
    at_rest: np.ndarray
    warnings: tuple[str, ...]


def read_bvh_frames(
    path: Path, data: bytes, start: int, tree: Hierarchy, frames: int, fps: float
) -> BvhFrames:
    """The frames from the byte `start` on; InputError when they do not fit the hierarchy."""
    layout = _Layout(tree)
    if layout.width == 0:
        raise fault(path, "at least one channel", "none in any joint", "Export the motion again.")
    most = (len(data) - start) // (2 * layout.width) + 1
    if frames <= most:
        check_size(path, frames, len(tree.names), fps)
    rotations = np.empty((frames if frames <= most else 0, len(tree.names), 4))
    positions = np.empty((len(rotations), len(layout.places)))
    poses = (frames, rotations, positions)
    found = None
    if not worth_loading(max(len(rotations) * layout.width, (len(data) - start) // _USUAL)):
        found = _plainly(data, start, layout, poses)
    if found is None:
        found = _scanned(path, data, start, layout, poses)
    there = found // layout.width
    note = f"the header says {frames} frames, {there} are there: the first {frames} used"
    return BvhFrames(
        rotations=rotations,
        positions={joint: positions[:, own] for joint, own in layout.own.items()},
        moving=layout.axes,
        at_rest=np.all(rotations[:, 0, 1:] == 0, axis=1),
        warnings=(note,) if there > frames else (),
    )


def _plainly(data: bytes, start: int, layout: "_Layout", poses: _Poses) -> int | None:
    """How many numbers there are, the frames filled in; None where that takes more than Python."""
    frames = poses[0]
    try:
        blocks = plain_blocks(data, start, 2 * layout.at_once, layout.width)
        found = _filled(blocks, layout, layout.turn_plainly, poses)
    except ValueError:
        return None
    return found if found >= frames * layout.width else None


def _scanned(path: Path, data: bytes, start: int, layout: "_Layout", poses: _Poses) -> int:
    """How many numbers there are, the frames filled in; InputError where they do not fit."""
    state = new_state(start)
    blocks = number_blocks(path, data, state, layout.at_once, layout.width)
    found = _filled(blocks, layout, layout.turn, poses)
    _check(path, data, start, state, (poses[0], found, layout.width))
    return found


def _filled(
    blocks: Iterator[Array], layout: "_Layout", turn: Callable[[Array, Array], None], poses: _Poses
) -> int:
    """How many numbers there are in blocks of whole rows, of which the first are filled in."""
    _, rotations, positions = poses
    done, found = 0, 0
    for values in blocks:
        found += len(values)
        rows = min(len(values) // layout.width, len(rotations) - done)
        if rows > 0:
            some = values[: rows * layout.width].reshape(rows, layout.width)
            turn(some, rotations[done : done + rows])
            positions[done : done + rows] = some[:, layout.places]
            done += rows
    return found


class _Layout:
    """Where in a row the channels of each joint lie."""

    def __init__(self, tree: Hierarchy) -> None:
        joints, columns, axes = [], [], []
        self.places: list[int] = []  # the columns of positions
        self.own: dict[int, slice] = {}  # of these columns, those of a joint
        self.axes: dict[int, list[int]] = {}
        column = 0
        for joint, channels in enumerate(tree.channels):
            kinds = list(enumerate(channels or [], start=column))
            column += len(kinds)
            turns = [(place, axis) for place, (kind, axis) in kinds if kind == "rotation"]
            moves = [(place, axis) for place, (kind, axis) in kinds if kind == "position"]
            if turns:
                others = [axis for axis in range(3) if axis not in [a for _, a in turns]]
                joints.append(joint)
                columns.append([place for place, _ in turns] + [-1] * len(others))
                axes.append([1 + axis for _, axis in turns] + [1 + axis for axis in others])
            if moves:
                self.own[joint] = slice(len(self.places), len(self.places) + len(moves))
                self.places += [place for place, _ in moves]
                self.axes[joint] = [axis for _, axis in moves]
        self.width = column
        self.at_once = max(1, _AT_ONCE // max(column, 1)) * column
        self._still = [joint for joint in range(len(tree.names)) if joint not in set(joints)]
        self._turns = tuple(np.array(part, dtype=np.int64) for part in (joints, columns, axes))

    def turn_plainly(self, values: Array, rotations: Array) -> None:
        """The same as `turn` by NumPy, the joints of one order of axes at a time."""
        rotations[:] = quat.IDENTITY
        joints, columns, axes = self._turns
        spread = np.where(columns >= 0, values[:, columns], 0.0)
        for order in {tuple(order) for order in axes.tolist()}:
            alike = np.all(axes == order, axis=1)
            names = "".join(AXES[axis - 1] for axis in order)
            rotations[:, joints[alike]] = quat.from_euler(np.radians(spread[:, alike]), names)

    def turn(self, values: Array, rotations: Array) -> None:
        """The rotations (F, J, 4) of rows (F, C)."""
        from stimuli.motion.formats.euler_loop import turn

        rotations[:, self._still] = quat.IDENTITY
        if len(self._turns[0]):
            turn(values, *self._turns, rotations)


def _check(path: Path, data: bytes, start: int, state: State, sizes: tuple[int, int, int]) -> None:
    """InputError when the numbers are not so many frames, naming the first odd line if there is.

    Frames may be wrapped over lines; but where there is a line for each frame, and yet not of as
    many words each, a number has moved into another frame's line.
    """
    frames, found, width = sizes
    there, rest = divmod(found, width)
    shifted = state[LINES] in (there, frames) and state[ODD_LINES] > 0
    if rest == 0 and there >= frames and not shifted:
        return
    wanted = f"{frames} frames of {width} numbers"
    if state[ODD_LINES]:
        raise fault(
            path,
            wanted,
            f"{found} numbers in all; frame {state[ODD_LINE]} has {state[ODD_WORDS]}",
            "The file is damaged or cut short; export it again.",
            line_of(data, int(state[ODD_BEGINS])),
        )
    todo = "The file is cut short, or its Frames: is wrong."
    raise fault(path, wanted, f"{there}", todo, line_of(data, start))
