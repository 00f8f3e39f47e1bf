"""What is said when the screen goes away in the middle of a session."""

import os
import sys
from typing import Any

_held: list[Any] = []  # a callback that C holds must not be collected


def tell_when_lost(told: str) -> None:
    """Have `told` printed, and the process end with 1, when the X server dies.

    The X library ends the process itself, after a line of its own; no Python exception comes of
    it. Elsewhere than on X11 there is nothing to do.
    """
    if sys.platform != "linux":
        return
    from pyglet.libs.x11 import xlib

    def lost(display: object) -> int:
        print(told, file=sys.stderr, flush=True)
        os._exit(1)

    _held.append(xlib.XSetIOErrorHandler.argtypes[0](lost))
    xlib.XSetIOErrorHandler(_held[-1])
