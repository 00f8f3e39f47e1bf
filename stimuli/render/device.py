"""What draws: a graphics card through EGL where there is one, else Mesa's software rasteriser.

Two drivers shade the edge of a figure otherwise, so that a group of clips is drawn by one.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from stimuli.errors import InputError

_WIDTH = r", \d+ bits"
_SOFTWARE = b"EGL_MESA_device_software"
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


def open_platform(wanted: str, width: int, height: int) -> Any:
    """pyrender's platform of the first wanted device that opens, its context current.

    Cards come before software. Whatever the last device raised where none opens; InputError
    where the machine has none such.
    """
    from pyrender.platforms import egl

    places = egl.query_devices()
    if not places:
        raise RuntimeError("EGL knows of no device")
    chosen = _chosen(wanted, [_is_software(device) for device in places])
    if not chosen:
        raise InputError(
            f"--device {wanted}: expected such a device, found {len(places)} in all that EGL "
            "knows of here; `segue doctor` lists them.\nTake another, or leave the option out."
        )
    for place in chosen:
        platform = egl.EGLPlatform(width, height, device=places[place])
        try:
            platform.init_context()
            platform.make_current()
        except Exception:  # a card that this user may not open fails in a driver's own way
            if place == chosen[-1]:
                raise
            continue
        return platform
    raise AssertionError("the last device either opened or raised")


def listed() -> str:
    """The devices that EGL knows of here, by number."""
    from pyrender.platforms import egl

    kinds = [
        "software" if _is_software(device) else f"card {device.name or ''}".strip()
        for device in egl.query_devices()
    ]
    return ", ".join(f"{place}: {kind}" for place, kind in enumerate(kinds))


def driver() -> str:
    """The renderer of the current context and its version, as the driver says them.

    Without the width of vectors that Mesa found on this processor, with which it draws the same.
    """
    from OpenGL import GL

    name, version = (GL.glGetString(key).decode() for key in (GL.GL_RENDERER, GL.GL_VERSION))
    return f"{re.sub(_WIDTH, '', name)} / OpenGL {version}"


def _chosen(wanted: str, software: Sequence[bool]) -> list[int]:
    """The devices' numbers in the order in which they are tried."""
    if wanted.isdecimal():
        return [int(wanted)] if int(wanted) < len(software) else []
    takes = DEVICES[wanted]
    return sorted((n for n, soft in enumerate(software) if takes(soft)), key=software.__getitem__)


def _is_software(device: Any) -> bool:
    from OpenGL import EGL
    from OpenGL.EGL.EXT.device_query import eglQueryDeviceStringEXT

    return _SOFTWARE in (eglQueryDeviceStringEXT(device._display, EGL.EGL_EXTENSIONS) or b"")
