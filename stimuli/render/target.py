"""The picture that is drawn into: several samples a pixel, and one picture to read them from."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

_SAMPLES = 4
_GRAIN = 32  # pixels, steps by which it grows


class Box(NamedTuple):
    """A part of a picture, in pixels from its top left."""

    left: int
    top: int
    right: int
    bottom: int

    @property
    def empty(self) -> bool:
        """Whether nothing is in it."""
        return self.left >= self.right or self.top >= self.bottom


def around(boxes: Sequence[Box]) -> Box:
    """The box around boxes."""
    left, top, right, bottom = zip(*boxes, strict=True)
    return Box(min(left), min(top), max(right), max(bottom))


def apart(boxes: Sequence[Box]) -> list[Box]:
    """Boxes that have no pixel in common and all those of a tall one and, if any, a wide one."""
    seen = [box for box in boxes if not box.empty]
    if len(seen) < 2:
        return seen
    tall, wide = seen
    wide = Box(min(tall.left, wide.left), wide.top, max(tall.right, wide.right), wide.bottom)
    parts = [
        wide,
        tall._replace(bottom=min(tall.bottom, wide.top)),
        tall._replace(top=max(tall.top, wide.bottom)),
    ]
    return [part for part in parts if not part.empty]


class Target:
    """A box of a picture of `width` × `height` pixels, drawn `scale` times as large and averaged.

    It is no larger than the largest box that was asked for: clearing a whole target takes a
    fraction of the time that clearing a part of a larger one does.
    """

    def __init__(self, gl: Any, width: int, height: int, scale: int) -> None:
        self._gl, self._scale = gl, scale
        self._picture = (width * scale, height * scale)
        self._room = (0, 0)
        self._made: list[tuple[int, list[int]]] = []

    def begin(self, box: Box, height: int, background: tuple[float, float, float]) -> None:
        """Clear a box of the picture, which is `height` pixels high, and draw there."""
        gl, scale = self._gl, self._scale
        self._box = box
        self._hold(scale * (box.right - box.left), scale * (box.bottom - box.top))
        x, y = scale * box.left, scale * (height - box.bottom)
        gl.glBindFramebuffer(gl.GL_FRAMEBUFFER, self._made[0][0])
        gl.glViewport(-x, -y, *self._picture)
        gl.glClearColor(*background, 1.0)
        gl.glClear(gl.GL_COLOR_BUFFER_BIT | gl.GL_DEPTH_BUFFER_BIT)

    def pixels(self, box: Box) -> NDArray[np.uint8]:
        """(height, width, 3) RGB of a box within the one that was begun, from its top."""
        gl, scale, whole = self._gl, self._scale, self._box
        width, height = scale * (box.right - box.left), scale * (box.bottom - box.top)
        x, y = scale * (box.left - whole.left), scale * (whole.bottom - box.bottom)
        corners = (x, y, x + width, y + height)
        drawn, read_from = (name for name, _ in self._made)
        gl.glBindFramebuffer(gl.GL_READ_FRAMEBUFFER, drawn)
        gl.glBindFramebuffer(gl.GL_DRAW_FRAMEBUFFER, read_from)
        gl.glBlitFramebuffer(*corners, *corners, gl.GL_COLOR_BUFFER_BIT, gl.GL_NEAREST)
        gl.glBindFramebuffer(gl.GL_READ_FRAMEBUFFER, read_from)
        raw = gl.glReadPixels(x, y, width, height, gl.GL_RGBA, gl.GL_UNSIGNED_BYTE)
        read = np.frombuffer(raw, dtype=np.uint8).reshape(height, width, 4)[::-1, :, :3]
        if self._scale == 1:
            return read
        n = self._scale
        cells = read.reshape(height // n, n, width // n, n, 3).sum(axis=(1, 3), dtype=np.uint32)
        return ((cells + n * n // 2) // (n * n)).astype(np.uint8)

    def _hold(self, width: int, height: int) -> None:
        """Make room for a box, if there is not enough."""
        if width <= self._room[0] and height <= self._room[1]:
            return
        sides = zip((width, height), self._room, self._picture, strict=True)
        wide, high = (min(max(-(-new // _GRAIN) * _GRAIN, old), most) for new, old, most in sides)
        self._free()
        self._room = (wide, high)
        self._made = [self._framebuffer(_SAMPLES, depth=True), self._framebuffer(0, depth=False)]

    def _free(self) -> None:
        for name, buffers in self._made:
            self._gl.glDeleteFramebuffers(1, [name])
            self._gl.glDeleteRenderbuffers(len(buffers), buffers)

    def _framebuffer(self, samples: int, depth: bool) -> tuple[int, list[int]]:
        gl = self._gl
        name = int(gl.glGenFramebuffers(1))
        gl.glBindFramebuffer(gl.GL_FRAMEBUFFER, name)
        kinds = [(gl.GL_COLOR_ATTACHMENT0, gl.GL_RGBA8)]
        if depth:
            kinds.append((gl.GL_DEPTH_ATTACHMENT, gl.GL_DEPTH_COMPONENT24))
        buffers = [int(gl.glGenRenderbuffers(1)) for _ in kinds]
        for (attachment, form), buffer in zip(kinds, buffers, strict=True):
            gl.glBindRenderbuffer(gl.GL_RENDERBUFFER, buffer)
            gl.glRenderbufferStorageMultisample(gl.GL_RENDERBUFFER, samples, form, *self._room)
            gl.glFramebufferRenderbuffer(gl.GL_FRAMEBUFFER, attachment, gl.GL_RENDERBUFFER, buffer)
        if gl.glCheckFramebufferStatus(gl.GL_FRAMEBUFFER) != gl.GL_FRAMEBUFFER_COMPLETE:
            raise RuntimeError(f"no picture of {self._room[0]} × {self._room[1]} pixels to draw in")
        return name, buffers
