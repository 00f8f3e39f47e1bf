"""A clip frame on the screen: one texture, refilled for every frame, drawn as a rectangle.

PsychoPy's image stimuli turn every picture into floats on the way to the card; a session changes
pictures sixty times a second, so its bytes go there directly.
"""

import ctypes
from typing import Any

import numpy as np
from numpy.typing import NDArray


class Panel:
    """A rectangle of the window, in pixels from its centre, that shows (H, W, 3) uint8 frames."""

    def __init__(self, centre: tuple[float, float], size: tuple[float, float]) -> None:
        from pyglet import gl

        self._gl = gl
        self._texture = gl.GLuint()
        self._shape: tuple[int, ...] = ()
        x, y = centre
        half_width, half_height = size[0] / 2, size[1] / 2
        self._corners = (
            (0.0, 0.0, x - half_width, y + half_height),
            (1.0, 0.0, x + half_width, y + half_height),
            (1.0, 1.0, x + half_width, y - half_height),
            (0.0, 1.0, x - half_width, y - half_height),
        )
        gl.glGenTextures(1, ctypes.byref(self._texture))
        gl.glBindTexture(gl.GL_TEXTURE_2D, self._texture)
        for name in (gl.GL_TEXTURE_MAG_FILTER, gl.GL_TEXTURE_MIN_FILTER):
            gl.glTexParameteri(gl.GL_TEXTURE_2D, name, gl.GL_LINEAR)
        for name in (gl.GL_TEXTURE_WRAP_S, gl.GL_TEXTURE_WRAP_T):
            gl.glTexParameteri(gl.GL_TEXTURE_2D, name, gl.GL_CLAMP_TO_EDGE)
        gl.glBindTexture(gl.GL_TEXTURE_2D, 0)

    def draw(self, window_size: tuple[int, int]) -> None:
        """Draw what it was last filled with into the window's back buffer."""
        gl = self._gl
        gl.glUseProgram(0)
        gl.glActiveTexture(gl.GL_TEXTURE0)
        gl.glEnable(gl.GL_TEXTURE_2D)
        gl.glBindTexture(gl.GL_TEXTURE_2D, self._texture)
        _push_pixel_matrices(gl, window_size)
        gl.glColor4f(1.0, 1.0, 1.0, 1.0)
        gl.glBegin(gl.GL_QUADS)
        for u, v, x, y in self._corners:
            gl.glTexCoord2f(u, v)
            gl.glVertex2f(x, y)
        gl.glEnd()
        _pop_matrices(gl)
        gl.glBindTexture(gl.GL_TEXTURE_2D, 0)
        gl.glDisable(gl.GL_TEXTURE_2D)

    def fill(self, frame: NDArray[np.uint8]) -> None:
        """Take a frame, to be drawn from now on; row 0 is the top."""
        gl = self._gl
        pixels = np.ascontiguousarray(frame)
        gl.glActiveTexture(gl.GL_TEXTURE0)
        gl.glBindTexture(gl.GL_TEXTURE_2D, self._texture)
        gl.glPixelStorei(gl.GL_UNPACK_ALIGNMENT, 1)
        height, width = pixels.shape[:2]
        form = (gl.GL_RGB, gl.GL_UNSIGNED_BYTE, pixels.ctypes.data)
        if pixels.shape == self._shape:
            gl.glTexSubImage2D(gl.GL_TEXTURE_2D, 0, 0, 0, width, height, *form)
        else:
            gl.glTexImage2D(gl.GL_TEXTURE_2D, 0, gl.GL_RGB8, width, height, 0, *form)
            self._shape = pixels.shape
        gl.glBindTexture(gl.GL_TEXTURE_2D, 0)

    def delete(self) -> None:
        """Give the texture back."""
        self._gl.glDeleteTextures(1, ctypes.byref(self._texture))


def _push_pixel_matrices(gl: Any, size: tuple[int, int]) -> None:
    gl.glMatrixMode(gl.GL_PROJECTION)
    gl.glPushMatrix()
    gl.glLoadIdentity()
    gl.glOrtho(-size[0] / 2, size[0] / 2, -size[1] / 2, size[1] / 2, -1.0, 1.0)
    gl.glMatrixMode(gl.GL_MODELVIEW)
    gl.glPushMatrix()
    gl.glLoadIdentity()


def _pop_matrices(gl: Any) -> None:
    gl.glPopMatrix()
    gl.glMatrixMode(gl.GL_PROJECTION)
    gl.glPopMatrix()
    gl.glMatrixMode(gl.GL_MODELVIEW)
