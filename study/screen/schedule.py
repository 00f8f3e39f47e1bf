"""Which clip frame belongs to which screen refresh, and which came late: arithmetic only."""

from collections.abc import Sequence
from typing import NamedTuple

NOMINAL_REFRESH = 60.0


class Due(NamedTuple):
    """A clip frame, and the refresh (from the first frame's) at which it is due."""

    frame: int
    refresh: int


def schedule(frames: int, fps: float, refresh_rate: float, pace: float = 1.0) -> list[Due]:
    """The refreshes at which the picture changes, from frame 0 at refresh 0 to the last frame.

    At pace 1 on a screen of twice the clip's rate each frame lasts two refreshes. Where time runs
    so fast that one refresh passes several frames, those between are left out; the last is shown.
    """
    per_refresh = fps * pace / refresh_rate
    dues: list[Due] = []
    refresh = 0
    while not dues or dues[-1].frame < frames - 1:
        frame = min(int(refresh * per_refresh + 1e-6), frames - 1)
        if not dues or frame > dues[-1].frame:
            dues.append(Due(frame, refresh))
        refresh += 1
    return dues


def last_refresh(frames: int, fps: float, refresh_rate: float, pace: float = 1.0) -> int:
    """The refresh at which the last frame has been shown for its time."""
    return max(round(frames * refresh_rate / (fps * pace)), 1)


def late_frames(dues: Sequence[Due], flips: Sequence[float], refresh_rate: float) -> int:
    """How many frames were flipped more than one refresh after they were due.

    `flips` are seconds, one for each entry of `dues`; the first is the time origin.
    """
    limit = 1.0 / refresh_rate
    return sum(
        flip - flips[0] - due.refresh / refresh_rate > limit + 1e-9
        for due, flip in zip(dues, flips, strict=True)
    )
