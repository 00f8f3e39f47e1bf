"""What a key is called: by what is printed on it, in the layouts that the X server has.

Psychtoolbox tells keys by their place, and PsychoPy calls each place what an American keyboard has
there: on a German one the key labelled Z is `y`, on a French one A is `q`. A participant is told
what is printed. Where a layout has no such letter, as a Russian or a Greek one alone, keys keep
their American places.
"""

import sys
from collections.abc import Mapping, Sequence
from typing import Any

from study.protocol.keys import KEY_NAMES

LEVELS = 4  # unshifted and shifted (in France digits are), of the first layout and of the second


def places_of(names: Sequence[str]) -> dict[str, str]:
    """PsychoPy's name for the place of each key, with the name of the key that lies there.

    Elsewhere than on X11 that is the key's own name.
    """
    codes = _codes_here() if sys.platform == "linux" else {}
    found: dict[str, str] = {}
    for name in names:
        called = [place for code in codes.get(name, ()) if (place := _american().get(code))]
        found |= dict.fromkeys(called or [name], name)
    return found


def codes_by_name(display: Any) -> dict[str, list[int]]:
    """The X keycodes of every key that a protocol may name, where one is so called most directly.

    `display` is a connection of python-xlib.
    """
    from Xlib import XK

    american = {name: code for code, name in _american().items()}
    found: dict[str, list[int]] = {}
    for name, symbol in KEY_NAMES.items():
        held = display.keysym_to_keycodes(XK.string_to_keysym(symbol))
        levels = sorted((level, code) for code, level in held if level < LEVELS)
        codes = [code for level, code in levels if level == levels[0][0]]
        found[name] = codes or [american[name]] * (name in american)
    return found


def names_by_code(codes: Mapping[str, Sequence[int]]) -> dict[int, list[str]]:
    """What each keycode is called."""
    found: dict[int, list[str]] = {}
    for name, held in codes.items():
        for code in held:
            found.setdefault(code, []).append(name)
    return found


def _codes_here() -> dict[str, list[int]]:
    from Xlib.display import Display
    from Xlib.error import DisplayError

    try:
        display = Display()
    except (DisplayError, OSError):
        return {}
    try:
        return codes_by_name(display)
    finally:
        display.close()


def _american() -> dict[int, str]:
    """PsychoPy's names of X keycodes, which it counts from 1."""
    from psychopy.hardware import keyboard

    return {place - 1: name for place, name in keyboard.keyNamesLinux.items()}
