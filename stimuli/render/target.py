"""The picture that is drawn into: several samples a pixel, and one picture to read them from."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

EDGE_SAMPLES = 4  # a pixel, of what has edges
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


class Target:
    """A box of a picture of `width` × `height` pixels, drawn `scale` times as large and averaged.

    With several `samples` a pixel it has depth too; with one it is for what lies flat and fades
    by itself. It is no larger than the largest box that was asked for: clearing a whole target
    takes a fraction of the time that clearing a part of a larger one does.
    """

    def __init__(self, gl: Any, width: int, height: int, scale: int, samples: int) -> None:
        self._gl, self._scale, self._samples = gl, scale, samples
        self._picture = (width * scale, height * scale)
        self._room = (0, 0)
        self._made: list[tuple[int, list[int]]] = []

    def begin(self, box: Box, background: tuple[float, float, float]) -> None:
        """Clear a box of the picture and draw there."""
        gl, scale = self._gl, self._scale
        self._size = (scale * (box.right - box.left), scale * (box.bottom - box.top))
        self._hold(*self._size)
        gl.glBindFramebuffer(gl.GL_FRAMEBUFFER, self._made[0][0])
        below = self._picture[1] - scale * box.bottom
        gl.glViewport(-scale * box.left, -below, *self._picture)
        gl.glClearColor(*background, 1.0)
        gl.glClear(gl.GL_COLOR_BUFFER_BIT | (gl.GL_DEPTH_BUFFER_BIT if self._samples > 1 else 0))

    def pixels(self) -> NDArray[np.uint8]:
        """(height, width, 3) RGB of the box that was begun."""
        gl, (width, height) = self._gl, self._size
        if self._samples > 1:
            drawn, read_from = (name for name, _ in self._made)
            corners = (0, 0, width, height)
            gl.glBindFramebuffer(gl.GL_READ_FRAMEBUFFER, drawn)
            gl.glBindFramebuffer(gl.GL_DRAW_FRAMEBUFFER, read_from)
            gl.glBlitFramebuffer(*corners, *corners, gl.GL_COLOR_BUFFER_BIT, gl.GL_NEAREST)
            gl.glBindFramebuffer(gl.GL_READ_FRAMEBUFFER, read_from)
        raw = gl.glReadPixels(0, 0, width, height, gl.GL_RGBA, gl.GL_UNSIGNED_BYTE)
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
        one = self._framebuffer(0, depth=False)
        many = [self._framebuffer(self._samples, depth=True)] if self._samples > 1 else []
        self._made = [*many, one]

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
