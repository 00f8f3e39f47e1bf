"""Which clip frame belongs to which screen refresh, and which came late: arithmetic only."""

from collections.abc import Sequence
from typing import NamedTuple

NOMINAL_REFRESH = 60.0
LATE = 0.5  # refreshes


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


def frames_late(dues: Sequence[Due], flips: Sequence[float], refresh_rate: float) -> list[int]:
    """The clip frames that were flipped more than half a refresh after they were due.

    A screen shows a frame at a refresh or at the next: halfway lies what neither is near, so that
    the jitter of a clock decides nothing. `flips` are seconds, one for each entry of `dues`; the
    first is the time origin.
    """
    limit = LATE / refresh_rate
    return [
        due.frame
        for due, flip in zip(dues, flips, strict=True)
        if flip - flips[0] - due.refresh / refresh_rate > limit
    ]


def late_frames(dues: Sequence[Due], flips: Sequence[float], refresh_rate: float) -> int:
    """How many frames came late (see `frames_late`)."""
    return len(frames_late(dues, flips, refresh_rate))


def never_shown(fps: float, refresh_rate: float) -> float:
    """The share of a clip's frames that a screen slower than the clip has no refresh for."""
    return max(0.0, 1 - refresh_rate / fps)


def divides(fps: float, refresh_rate: float) -> bool:
    """Whether each frame of a clip lasts equally many refreshes, to a hundredth of one."""
    ratio = refresh_rate / fps
    return abs(ratio - round(ratio)) < 0.01 and ratio > 0.99
