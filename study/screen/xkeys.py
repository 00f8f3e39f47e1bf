"""The keys of a window as the X server saw them, on the session's clock.

Every event of a key carries the server's time in whole milliseconds. How that clock lies against
the session's is measured by round trips: the server stamps a change of a property between two
readings of the session's clock. Each round trip bounds the offset; all of them together leave less
than a millisecond. So an event may be read late without its time being late.
"""

import time
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from study.screen.labels import codes_by_name, names_by_code
from study.screen.press import Press
from study.session.stage import ScreenLostError

PROBES = 64
TICK = 1e-3  # the server counts whole milliseconds
_WRAP = 1 << 32  # of which its stamps hold 32 bits


class ClockFit(NamedTuple):
    """Server seconds minus session seconds, how far that may be off, and the spread of a stamp."""

    offset: float
    uncertainty: float
    jitter: float
    round_trip: float


def fit_clock(before: Sequence[float], stamps: Sequence[float], after: Sequence[float]) -> ClockFit:
    """The offset of a clock of whole ticks from round trips (seconds).

    A stamp is the server's time rounded down, taken between `before` and `after`: the offset lies
    above `stamp - after` and below `stamp + TICK - before`. The narrowest bounds are kept; where
    they contradict each other (a clock was set meanwhile) the median stands in. `jitter` is the
    standard deviation of what single stamps say.
    """
    sent, told, back = (np.asarray(values, float) for values in (before, stamps, after))
    low, high = float(np.max(told - back)), float(np.min(told + TICK - sent))
    single = told + TICK / 2 - (sent + back) / 2
    if low <= high:
        offset, uncertainty = (low + high) / 2, (high - low) / 2
    else:
        offset, uncertainty = float(np.median(single)), (low - high) / 2 + TICK / 2
    return ClockFit(offset, uncertainty, float(np.std(single)), float(np.median(back - sent)))


class ServerKeyboard:
    """Keys of a window, through a connection of its own.

    `windows` are the X identifiers of the window and of those within that fill it.
    """

    def __init__(self, windows: Sequence[int], display: str | None = None) -> None:
        from Xlib import X
        from Xlib.display import Display

        self._display: Any = Display(display)
        self._windows = [self._display.create_resource_object("window", n) for n in windows]
        for window in self._windows:
            window.change_attributes(event_mask=X.KeyPressMask | X.KeyReleaseMask)
        self._own = self._display.screen().root.create_window(
            0, 0, 1, 1, 0, 0, X.InputOnly, event_mask=X.PropertyChangeMask
        )
        self._atom = self._display.intern_atom("SEGUE_CLOCK")
        self._names = names_by_code(codes_by_name(self._display))
        self._epoch = 0
        self._waiting: list[tuple[float, str]] = []
        self._down: set[int] = set()
        self._let_go: dict[int, int] = {}  # when a key that was down was let go
        self._zero = time.perf_counter()
        self._fits: list[ClockFit] = []
        self.measure()
        self._focus()

    def measure(self) -> None:
        """Measure the server's clock against the session's by round trips."""
        self._read()
        if not self._fits:
            self._epoch = self._stamp()[1]
        trips = []
        for n in range(PROBES):
            trips.append(self._stamp())
            time.sleep((n % 8) * TICK / 8)  # at other parts of a tick each time
        before, stamps, after = zip(*trips, strict=True)
        self._fits.append(fit_clock(before, [self._seconds(stamp) for stamp in stamps], after))

    def listen(self) -> None:
        """From now on keys count."""
        self._zero = time.perf_counter()

    def since(self) -> float:
        """Seconds since `listen`."""
        return time.perf_counter() - self._zero

    def pressed(self, names: Sequence[str], clear: bool = True) -> list[Press]:
        """Those of these keys pressed since `listen`, in order."""
        self._read()
        self._waiting = [entry for entry in self._waiting if entry[0] >= self._zero]
        found = [(at, name) for at, name in self._waiting if name in names]
        if clear:
            self._waiting = [entry for entry in self._waiting if entry not in found]
        return [Press(name, at - self._zero) for at, name in found]

    def timing(self) -> dict[str, object]:
        """How exact the server's stamps were found, in milliseconds, by block."""
        return {
            "keyboard": "x-server",
            "keyboard_jitter_ms": [round(1e3 * fit.jitter, 3) for fit in self._fits],
            "keyboard_uncertainty_ms": [round(1e3 * fit.uncertainty, 3) for fit in self._fits],
            "keyboard_round_trip_ms": [round(1e3 * fit.round_trip, 3) for fit in self._fits],
        }

    def close(self) -> None:
        """Close the connection."""
        self._display.close()

    def _focus(self) -> None:
        """Ask for the keys: where no window manager runs, nobody else gives a window the focus."""
        from Xlib import X

        self._windows[0].set_input_focus(X.RevertToParent, X.CurrentTime, onerror=_ignored)
        self._display.sync()

    def _stamp(self) -> tuple[float, int, float]:
        """The server's time of now, between two readings of the session's clock."""
        from Xlib import X

        before = time.perf_counter()
        self._own.change_property(self._atom, self._atom, 8, b"")
        while True:
            event = self._display.next_event()
            after = time.perf_counter()
            if event.type == X.PropertyNotify and event.window.id == self._own.id:
                return before, int(event.time), after
            self._take(event)

    def _seconds(self, stamp: int) -> float:
        """Server seconds since the first stamp, whose 32 bits may have run over since."""
        passed = (stamp - self._epoch) % _WRAP
        return (passed - _WRAP if passed > _WRAP // 2 else passed) * TICK

    def _read(self) -> None:
        from Xlib.error import ConnectionClosedError

        try:
            for _ in range(self._display.pending_events()):
                self._take(self._display.next_event())
        except ConnectionClosedError as error:
            raise ScreenLostError from error

    def _take(self, event: Any) -> None:
        """Keep a key that went down; a held key repeats itself, let go and down at one time."""
        from Xlib import X

        if event.type == X.MappingNotify:
            self._display.refresh_keyboard_mapping(event)
            self._names = names_by_code(codes_by_name(self._display))
        elif event.type == X.KeyRelease and event.detail in self._down:
            self._down.remove(event.detail)
            self._let_go[event.detail] = event.time
        elif event.type == X.KeyPress:
            self._down.add(event.detail)
            if not self._fits or self._let_go.get(event.detail) == event.time:
                return
            at = self._seconds(event.time) + TICK / 2 - self._fits[-1].offset
            self._waiting += [(at, name) for name in self._names.get(event.detail, ())]


def _ignored(error: object, request: object) -> None:
    """A window that is not shown yet cannot have the focus; it gets it when it is."""
