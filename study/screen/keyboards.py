"""Keyboards: which keys were pressed since the last frame was flipped, and when.

Psychtoolbox's queue reads the devices in a thread of real-time priority, and takes the whole
process down where the user may not have that. There the keys come as events of the session's own
window, timed by the X server (`study.screen.xkeys`), not by when this process looked.
"""

from collections.abc import Sequence
from typing import Any

from stimuli.errors import InputError
from study.screen.labels import places_of
from study.screen.press import Keyboard, Press
from study.screen.priority import may_have_priority


def open_keyboard(window: Any) -> Keyboard:
    """The best keyboard that this user may have, for a window of PsychoPy that is open."""
    if may_have_priority():
        return PtbKeyboard()
    from study.screen.xkeys import ServerKeyboard

    handle = window.winHandle
    return ServerKeyboard([int(handle._window), int(handle._view)])


class PtbKeyboard:
    """PsychoPy's keyboard on psychtoolbox's queue."""

    def __init__(self) -> None:
        from psychopy.hardware import keyboard

        self._keys = keyboard.Keyboard()
        backend = self._keys.getBackend()
        if backend != "ptb":
            raise InputError(
                f"keyboard: expected PsychoPy's backend 'ptb', found {backend!r}, which times keys "
                "badly;\ninstall libjack-jackd2-0 and libasound2 (Debian), or see `segue doctor`"
            )
        self._listening_since = 0.0
        self._places: dict[str, str] = {}

    def listen(self) -> None:
        """From now on keys count."""
        from psychopy import logging

        self._keys.clock.reset()
        self._keys.clearEvents()
        self._listening_since = logging.defaultClock.getTime()

    def since(self) -> float:
        """Seconds since `listen`."""
        return float(self._keys.clock.getTime())

    def pressed(self, names: Sequence[str], clear: bool = True) -> list[Press]:
        """Keys since `listen`; psychopy gives those that are held and those let go apart."""
        if unknown := [name for name in names if name not in self._places.values()]:
            self._places |= places_of(unknown)
        wanted = {place: name for place, name in self._places.items() if name in names}
        keys = [
            key
            for let_go in (False, True)
            for key in self._keys.getKeys(list(wanted), waitRelease=let_go, clear=clear)
            if key.tDown >= self._listening_since and key.rt >= 0
        ]
        pressed = sorted(keys, key=lambda key: key.tDown)
        return [Press(wanted[key.name], float(key.rt)) for key in pressed]

    def measure(self) -> None:
        """Its times are taken on the session's own clock; the layout may be another by now."""
        self._places.clear()

    def timing(self) -> dict[str, object]:
        """A queue filled by a thread of real-time priority; nothing to measure."""
        return {"keyboard": "ptb"}

    def close(self) -> None:
        """The queue ends with the process."""
