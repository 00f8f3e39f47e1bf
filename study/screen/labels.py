"""What a key is called: by what is printed on it, in the layout that the X server has.

Psychtoolbox tells keys by their place, and PsychoPy calls each place what an American keyboard has
there: on a German one the key labelled Z is `y`, on a French one A is `q`. A participant is told
what is printed.
"""

import sys
from collections.abc import Sequence

from study.protocol.keys import KEY_NAMES

LEVELS = 2  # a key is called by what it is unshifted, and shifted: in France digits are shifted


def places_of(names: Sequence[str]) -> dict[str, str]:
    """PsychoPy's name for the place of each key, with the name of the key that lies there.

    Elsewhere than on X11, and for keys that the layout does not have, that is the key's own name.
    """
    found: dict[str, str] = {}
    codes = _codes_of(names) if sys.platform == "linux" else {}
    for name in names:
        called = [place for code in codes.get(name, ()) if (place := _place(code))]
        found |= dict.fromkeys(called or [name], name)
    return found


def _codes_of(names: Sequence[str]) -> dict[str, list[int]]:
    """The X keycodes of keys by name, those that are so called unshifted first."""
    from Xlib import XK
    from Xlib.display import Display
    from Xlib.error import DisplayError

    try:
        display = Display()
    except (DisplayError, OSError):
        return {}
    try:
        return {
            name: [
                code
                for code, level in sorted(
                    display.keysym_to_keycodes(XK.string_to_keysym(KEY_NAMES.get(name, ""))),
                    key=lambda entry: entry[1],
                )
                if level < LEVELS
            ]
            for name in names
        }
    finally:
        display.close()


def _place(code: int) -> str | None:
    """PsychoPy's name of an X keycode, which it counts from 1."""
    from psychopy.hardware import keyboard

    return keyboard.keyNamesLinux.get(code + 1)
