"""What draws: a graphics card through EGL where there is one, else Mesa's software rasteriser.

Two drivers shade the edge of a figure otherwise, so that a group of clips is drawn by one.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from stimuli.errors import InputError

_WIDTH = r", \d+ bits"
SOFTWARE = b"EGL_MESA_device_software"  # an extension of devices that are none
DEVICES: Mapping[str, Callable[[bool], bool]] = {  # which devices are taken, by being software
    "auto": lambda software: True,
    "gpu": lambda software: not software,
    "software": lambda software: software,
}


def check_device(wanted: str) -> None:
    """InputError unless it is a word for a device, or its number."""
    if wanted not in DEVICES and not wanted.isdecimal():
        raise InputError(
            f"--device: expected {', '.join(DEVICES)} or a device's number, found {wanted!r}."
        )


def chosen(wanted: str, software: Sequence[bool]) -> list[int]:
    """The wanted devices' numbers in the order in which they are tried, cards first.

    `software` says it of each device of the machine; InputError where none of several is wanted.
    """
    if wanted.isdecimal():
        found = [int(wanted)] if int(wanted) < len(software) else []
    else:
        takes = DEVICES[wanted]
        kept = [place for place, soft in enumerate(software) if takes(soft)]
        found = sorted(kept, key=software.__getitem__)
    if software and not found:
        raise InputError(
            f"--device {wanted}: expected such a device, found {len(software)} in all that EGL "
            "knows of here; `segue doctor` lists them.\nTake another, or leave the option out."
        )
    return found


def listed(software: Sequence[bool]) -> str:
    """The devices of a machine by number, in words."""
    kinds = ("software" if soft else "card" for soft in software)
    return ", ".join(f"{place}: {kind}" for place, kind in enumerate(kinds))


def driver(gl: Any) -> str:
    """The renderer of the current context and its version, as the driver says them.

    Without the width of vectors that Mesa found on this processor, with which it draws the same.
    """
    name, version = (gl.glGetString(key).decode() for key in (gl.GL_RENDERER, gl.GL_VERSION))
    return f"{re.sub(_WIDTH, '', name)} / OpenGL {version}"
