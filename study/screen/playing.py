"""Clip frames over the refreshes of a screen: each from when it is due, and none left out."""

import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np

from study.screen.photodiode import Patch
from study.screen.refresh import Refresh
from study.screen.schedule import Due

SPIN_SECONDS = 0.002
ROOM = 0.4  # of a refresh that a flip may take to have time for one that changes nothing


class Flip(NamedTuple):
    """What a refresh showed: a frame, when (seconds), and at which refresh it was due; None where
    the frame was there before."""

    frame: int
    due: int | None
    at: float


class Flipping(Protocol):
    """What clips are flipped by; `rate` in Hz."""

    rate: float

    def now(self) -> float:
        """Seconds."""

    def flip(self) -> float:
        """Show what was drawn; when it was shown."""

    def sleep_until(self, due: float) -> None:
        """Wait until it is time to flip for what is due then."""

    def idle(self) -> bool:
        """Whether there is time for a flip that changes nothing."""


def play(
    dues: Sequence[Due], end: int, flipping: Flipping, draw: Callable[[int], None],
    again: Callable[[], None],
) -> list[Flip]:  # fmt: skip
    """Flip at every refresh until `end`, which waits for the last frame's time to pass.

    `draw` draws the frame of that place in `dues`, `again` what was drawn last. A frame that comes
    late is shown late, and those behind it one a refresh until they are in time again.
    """
    place, refresh, rate = 0, 0, flipping.rate
    draw(place)
    flips = [Flip(dues[0].frame, 0, flipping.flip())]
    first = flips[0].at
    while True:
        refresh = max(refresh + 1, round((flipping.now() - first) * rate) + 1)
        if place + 1 < len(dues) and dues[place + 1].refresh <= refresh:
            place += 1
            draw(place)
            due: int | None = dues[place].refresh
        elif refresh >= end and place + 1 == len(dues):
            break
        elif flipping.idle():
            again()
            due = None
        else:
            flipping.sleep_until(first + refresh / rate)
            continue
        flipping.sleep_until(first + refresh / rate)
        flips.append(Flip(dues[place].frame, due, flipping.flip()))
    flipping.sleep_until(first + end / rate)
    return flips


class WindowFlips:
    """The flips of a PsychoPy window: at the screen's refreshes, else paced by the clock."""

    def __init__(self, window: Any, refresh: Refresh, patch: Patch | None = None) -> None:
        self._window, self._patch = window, patch
        self._paced = not refresh.vsync
        self.rate = refresh.rate
        self._took: deque[float] = deque([0.0], maxlen=15)  # seconds that the last ones took
        self.zero: float | None = None  # the first flip, on `now`'s clock
        self.zero_wall: float | None = None  # and in Unix time

    def now(self) -> float:
        """Seconds of the clock that flips are timed by."""
        return time.perf_counter()

    def flip(self) -> float:
        """Show what was drawn, with the photodiode's square on it; when it was shown."""
        if self._patch:
            self._patch.draw()
        begun = time.perf_counter()
        self._window.flip()
        now = time.perf_counter()
        self._took.append(now - begun)
        if self.zero is None:
            self.zero, self.zero_wall = now, time.time()
        return now

    def idle(self) -> bool:
        """Whether there is time for a flip that changes nothing, where no refresh waits for it."""
        return not self._paced or float(np.median(self._took)) < ROOM / self.rate

    def sleep_until(self, due: float) -> None:
        """Wait for a due flip: half a refresh before it, or as long as flips take where the screen
        waits for none."""
        at = due - (float(np.median(self._took)) if self._paced else 0.5 / self.rate)
        rest = at - time.perf_counter() - SPIN_SECONDS
        if rest > 0:
            time.sleep(rest)
        while time.perf_counter() < at:
            pass
