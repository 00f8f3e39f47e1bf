"""Memory that the window and its decoder share: a ring of frames for each clip on the screen.

A file that both map; in front of the frames stand numbers of eight bytes: which clips are meant
(`TURN`), which are being decoded (`BEGUN`: until they are those, nothing of them is there), and for
each lane how many frames were decoded and how many are done with.
"""

import mmap
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

MOST_BYTES = 400_000_000  # of all lanes, whatever the clips
_AHEAD = 45  # frames of a clip that wait decoded, at most
LANES = 8
FIRST_BYTE = 4096
TURN, BEGUN, MADE, DONE = 0, 1, 8, 16  # places among the numbers; those of lane n come n after


@dataclass(frozen=True)
class Lane:
    """Where the ring of one clip lies: its first byte, its frames, their shape."""

    number: int
    offset: int
    slots: int
    shape: tuple[int, int, int]


class Ring:
    """The shared memory as one process sees it; whoever makes it removes it."""

    def __init__(self, path: Path | None = None) -> None:
        self.path, self._owner = path or _made(), path is None
        with self.path.open("r+b") as stream:
            self._memory = mmap.mmap(stream.fileno(), 0)
        self.numbers: NDArray[np.int64] = np.frombuffer(self._memory, np.int64, FIRST_BYTE // 8)

    def frames(self, lane: Lane) -> NDArray[np.uint8]:
        """The frames of a lane, (slots, height, width, 3), in place."""
        size = lane.slots * int(np.prod(lane.shape))
        flat = np.frombuffer(self._memory, np.uint8, size, lane.offset)
        return flat.reshape(lane.slots, *lane.shape)

    def close(self) -> None:
        """Give the memory up; views of its frames stay valid while somebody holds them."""
        if self._owner:
            self.path.unlink(missing_ok=True)


def _made() -> Path:
    """A file of that size where memory is shared, else among temporary files; none is filled."""
    for folder in (Path("/dev/shm"), Path(tempfile.gettempdir())):
        if folder.is_dir() and os.access(folder, os.W_OK):
            handle, name = tempfile.mkstemp(prefix="segue-ring-", dir=folder)
            os.truncate(handle, FIRST_BYTE + MOST_BYTES)
            os.close(handle)
            return Path(name)
    raise OSError("no folder for temporary files can be written")


def lanes_for(shapes: list[tuple[int, int, int]], frames: int) -> list[Lane]:
    """Room for clips of these shapes, of so many frames each, within MOST_BYTES together."""
    found, offset = [], FIRST_BYTE
    share = MOST_BYTES // max(len(shapes), 1)
    for number, shape in enumerate(shapes):
        size = int(np.prod(shape))
        slots = max(min(frames, _AHEAD, share // size), 2)
        found.append(Lane(number, offset, slots, shape))
        offset += slots * size
    return found
