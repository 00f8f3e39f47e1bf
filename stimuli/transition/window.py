"""Which frames of two motions a blend mixes, and with what weights: the two specifications.

The result counts its frames as the *from* motion A does. Frame n of it takes frame n of A and
frame n + lag of B; frames before `first` are A's alone, those after `last` are B's.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from stimuli.errors import InputError
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion

LONGEST = 60


@dataclass(frozen=True)
class Window:
    """Frames `first` … `last` of A are mixed with `first + lag` … of B.

    B is aligned with A at A's frame `anchor`, where the weight of B is `at_anchor`.
    """

    first: int
    last: int
    lag: int
    anchor: int
    at_anchor: float
    frames: int

    def fits(self, a: Motion, b: Motion) -> bool:
        """Whether both motions have all the frames that are mixed."""
        return (
            self.first >= 0
            and self.last < len(a)
            and self.first + self.lag >= 0
            and self.last + self.lag < len(b)
        )

    @property
    def weights(self) -> Array:
        """Weight of B over the mixed frames: a slope of 1/(b+1) a frame, 0 to 1 over them."""
        steps = np.arange(self.first, self.last + 1)
        return self.at_anchor + (steps - self.anchor) / (self.frames + 1)


def start_end(i: int, j: int, frames: int) -> Window:
    """Blending begins at frame i of A and ends at frame j of B: A[i+t−1] with B[j−b+t]."""
    return Window(i, i + frames - 1, j - frames + 1 - i, i, 1 / (frames + 1), frames)


def center_aligned(i: int, j: int, frames: int) -> Window:
    """Frames i of A and j of B coincide at 50 %; b frames are mixed, b + 1 where b is even."""
    half = frames // 2
    return Window(i - half, i + half, j - i, i, 0.5, frames)


SPECIFICATIONS: Mapping[str, Callable[[int, int, int], Window]] = MappingProxyType(
    {"start-end": start_end, "center-aligned": center_aligned}
)


def specified(specification: str) -> Callable[[int, int, int], Window]:
    """The window function of a specification; InputError for an unknown one."""
    if specification not in SPECIFICATIONS:
        raise InputError(
            f"specification: expected {' or '.join(SPECIFICATIONS)}, found {specification!r}."
        )
    return SPECIFICATIONS[specification]


Fits = Callable[[Window, Motion, Motion], bool]


def longest_fitting(
    a: Motion, b: Motion, i: int, j: int, specification: str,
    fits: Fits = Window.fits, most: int = LONGEST,
) -> int:  # fmt: skip
    """The longest blend, up to `most` frames, whose window both motions have; 0 when none has."""
    window = specified(specification)
    fitting = [n for n in range(1, most + 1) if fits(window(i, j, n), a, b)]
    return max(fitting, default=0)


def check_frames(a: Motion, b: Motion, i: int, j: int) -> None:
    """InputError unless the motions have frames i and j."""
    for motion, frame, which in ((a, i, "from"), (b, j, "to")):
        if not 0 <= frame < len(motion):
            raise InputError(
                f"the {which} motion: expected a frame from 0 to {len(motion) - 1}, found {frame}."
            )
