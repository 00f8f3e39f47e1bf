"""An OpenGL context without a window, through EGL: of a card where there is one, else in software.

One context a process; close it before the process ends.
"""

import ctypes
import os
from typing import Any

from stimuli.errors import InputError, MachineError
from stimuli.render.device import SOFTWARE, chosen

GRAPHICS = (
    "install libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri (Debian; it needs no screen and no card), "
    "or render on another machine and bring the set over"
)
_DEVICE = 0x313F  # EGL_PLATFORM_DEVICE_EXT
_VERSION = (4, 1)
_MOST_DEVICES = 32


class EglContext:
    """A current context of the first device that opens, of those wanted (see `device`).

    MachineError where none does, InputError where the machine has none such.
    """

    def __init__(self, device: str = "auto") -> None:
        try:
            self._egl, self._display, self._context = _first(device)
        except (MachineError, InputError):
            raise
        except Exception as error:  # each driver and binding fails in a way of its own
            why = " ".join(str(error).split()) or type(error).__name__
            raise MachineError(
                f"rendering: expected a device for OpenGL by EGL, found none ({why});\n{GRAPHICS}"
            ) from error

    def close(self) -> None:
        """Free the context; it must not outlive its process."""
        if self._display is not None:
            egl = self._egl
            egl.eglMakeCurrent(
                self._display, egl.EGL_NO_SURFACE, egl.EGL_NO_SURFACE, egl.EGL_NO_CONTEXT
            )
            egl.eglDestroyContext(self._display, self._context)
            egl.eglTerminate(self._display)
            self._display = None


def import_gl() -> Any:
    """PyOpenGL's functions for EGL; the platform is read from the environment at its import."""
    os.environ["PYOPENGL_PLATFORM"] = "egl"
    from OpenGL import GL

    return GL


def device_kinds() -> list[bool]:
    """Whether each of EGL's devices is software; the default alone where they are not listed."""
    import_gl()
    from OpenGL import EGL as egl

    devices = _devices(egl)
    return [True] if devices is None else [_is_software(egl, device) for device in devices]


def _first(wanted: str) -> tuple[Any, Any, Any]:
    places = chosen(wanted, device_kinds())
    for place in places:
        try:
            return _made(place)
        except Exception:  # a card that this user may not open fails in a driver's own way
            if place == places[-1]:
                raise
    raise RuntimeError("EGL knows of no device")


def _made(place: int) -> tuple[Any, Any, Any]:
    from OpenGL import EGL as egl

    display = _display_of(egl, place)
    if not egl.eglInitialize(display, None, None):
        raise RuntimeError("eglInitialize failed")
    wanted = [
        egl.EGL_SURFACE_TYPE, egl.EGL_PBUFFER_BIT, egl.EGL_RENDERABLE_TYPE, egl.EGL_OPENGL_BIT,
        egl.EGL_NONE,
    ]  # fmt: skip
    configs, count = (egl.EGLConfig * 1)(), ctypes.c_long()
    egl.eglChooseConfig(display, (ctypes.c_int * len(wanted))(*wanted), configs, 1, count)
    if not count.value:
        raise RuntimeError("no configuration for OpenGL")
    egl.eglBindAPI(egl.EGL_OPENGL_API)
    version = [
        egl.EGL_CONTEXT_MAJOR_VERSION, _VERSION[0], egl.EGL_CONTEXT_MINOR_VERSION, _VERSION[1],
        egl.EGL_CONTEXT_OPENGL_PROFILE_MASK, egl.EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
        egl.EGL_NONE,
    ]  # fmt: skip
    context = egl.eglCreateContext(
        display, configs[0], egl.EGL_NO_CONTEXT, (ctypes.c_int * len(version))(*version)
    )
    if not egl.eglMakeCurrent(display, egl.EGL_NO_SURFACE, egl.EGL_NO_SURFACE, context):
        raise RuntimeError("eglMakeCurrent failed")
    return egl, display, context


def _devices(egl: Any) -> list[Any] | None:
    """EGL's devices; None where it cannot list them."""
    query = egl.eglGetProcAddress(b"eglQueryDevicesEXT")
    if not query or not egl.eglGetProcAddress(b"eglGetPlatformDisplayEXT"):
        return None
    pointer, integer = ctypes.c_void_p, ctypes.c_int
    list_devices = ctypes.CFUNCTYPE(
        ctypes.c_uint, integer, ctypes.POINTER(pointer), ctypes.POINTER(integer)
    )(query)
    devices, count = (pointer * _MOST_DEVICES)(), integer()
    list_devices(_MOST_DEVICES, devices, ctypes.byref(count))
    return list(devices[: count.value])


def _is_software(egl: Any, device: Any) -> bool:
    query = egl.eglGetProcAddress(b"eglQueryDeviceStringEXT")
    told = ctypes.CFUNCTYPE(ctypes.c_char_p, ctypes.c_void_p, ctypes.c_int)(query)
    return SOFTWARE in (told(device, egl.EGL_EXTENSIONS) or b"")


def _display_of(egl: Any, place: int) -> Any:
    """The display of an EGL device; of the default one where devices cannot be listed."""
    devices = _devices(egl)
    if devices is None:
        return egl.eglGetDisplay(egl.EGL_DEFAULT_DISPLAY)
    get = egl.eglGetProcAddress(b"eglGetPlatformDisplayEXT")
    pointer = ctypes.c_void_p
    display_of = ctypes.CFUNCTYPE(egl.EGLDisplay, ctypes.c_uint, pointer, pointer)(get)
    return display_of(_DEVICE, devices[place], None)
