"""A way from one motion to another through others: pieces of clips, one put behind the other."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from stimuli.motion.skeleton import Motion
from stimuli.transition.footlock import lock_feet
from stimuli.transition.smooth import SPREAD_OVER, smoothed_cut
from stimuli.transition.window import center_aligned

Cutting = Callable[[Motion, Motion, int, int], Motion]  # frame i of A met by frame j of B


@dataclass(frozen=True, eq=False)
class Piece:
    """Frames `first` to `last` of a clip, both played. All clips are on one body."""

    clip: str
    motion: Motion
    first: int
    last: int

    def __len__(self) -> int:
        return self.last - self.first + 1


@dataclass(frozen=True, eq=False)
class Route:
    """What is played between frame i of A, which it leaves, and frame j of B, with which it ends.

    `leaves` and `enters` are those frames; the last piece is of B. `cost` is of all its cuts.
    """

    from_clip: str
    leaves: int
    enters: int
    pieces: tuple[Piece, ...]
    cost: float

    @property
    def frames(self) -> int:
        """Frames from A[i] to B[j]."""
        return sum(map(len, self.pieces))

    @property
    def cuts(self) -> int:
        """How often a clip is left for another place; A may go on in the first piece."""
        first = self.pieces[0]
        return len(self.pieces) - (first.clip == self.from_clip and first.first == self.leaves + 1)


def put_together(
    begun: Motion, pieces: Sequence[Piece], cutting: Cutting = smoothed_cut, locked: bool = False
) -> tuple[Motion, list[int]]:
    """A motion gone on with by pieces, each clip played to its end behind the last one.

    Returns the motion, and the index of the last frame before each piece, the motion's own end
    being the first. `locked` holds feet that stand.
    """
    motion, end, cuts = begun, len(begun) - 1, [len(begun) - 1]
    for piece in pieces:
        joined = cutting(motion, piece.motion, end, piece.first - 1)
        if locked:
            window = center_aligned(end, piece.first - 1, SPREAD_OVER)
            joined = lock_feet(joined, motion, piece.motion, window)
        motion, end = joined, end + len(piece)
        cuts.append(end)
    return motion, cuts
