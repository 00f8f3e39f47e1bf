"""Drawing the ground of a clip: its grid and its shadow, under the figure."""

import ctypes
from typing import Any

import numpy as np

from stimuli.render.appearance import Appearance
from stimuli.render.ground import (
    CLEAR,
    DARKEST,
    GONE,
    GROUNDS,
    LINE,
    LINE_DARK,
    SHADOW_CELLS,
    SHADOW_SPAN,
    crossing,
    darkened,
    lattice,
    shadow,
)
from stimuli.render.programs import (
    GRID_FRAGMENT,
    GRID_VERTEX,
    SHADOW_FRAGMENT,
    SHADOW_VERTEX,
    Program,
)
from stimuli.render.shapes import Floats

_CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]], dtype=np.float32)
_AROUND = np.linspace(0, 2 * np.pi, 24, endpoint=False)


class Floor:
    """The ground of a look; it darkens what is behind the figure, which is drawn after it."""

    def __init__(self, gl: Any, look: Appearance) -> None:
        self._gl, self.parts = gl, GROUNDS[look.ground]
        self._shaded = False
        if "shadow" in self.parts:
            self._shadow = Program(gl, SHADOW_VERTEX, SHADOW_FRAGMENT)
            self._square = vertices(gl, _CORNERS, (2,))
            self._picture = _texture(gl)
            self._shadow.use()
            gl.glUniform1f(self._shadow.at("darkest"), DARKEST)
        if "grid" in self.parts:
            self._grid = Program(gl, GRID_VERTEX, GRID_FRAGMENT)
            self._grid.use()
            size = (look.width * look.supersample, look.height * look.supersample)
            gl.glUniform3f(self._grid.at("fading"), LINE_DARK, CLEAR, GONE)
            gl.glUniform2f(self._grid.at("half_picture"), size[0] / 2, size[1] / 2)
            gl.glUniform1f(self._grid.at("half_line"), LINE * size[1] / 2)
            corners = lattice()
            self._lines, self._count = vertices(gl, corners, (2, 2, 1)), len(corners)

    def reach(self, casters: Floats, floor: float, middle: Floats) -> Floats:
        """(N, 3) points about all that may be darkened, for a body at `middle` (2,)."""
        rings = []
        if "grid" in self.parts:
            rings.append((middle, GONE))
        if "shadow" in self.parts:
            centre = casters[:, [0, 2]].mean(axis=0)
            away = float(np.hypot(*(casters[:, [0, 2]] - centre).T).max())
            rings.append((centre, min(SHADOW_SPAN / np.sqrt(2), away + 0.7)))
        points = [
            [
                x + radius * np.cos(_AROUND),
                np.full_like(_AROUND, floor),
                z + radius * np.sin(_AROUND),
            ]
            for (x, z), radius in rings
        ]
        return np.concatenate([np.stack(ring, axis=-1) for ring in points])

    def lay(
        self, lens: Floats, view: Floats, casters: Floats, floor: float,
        middle: Floats,
    ) -> None:  # fmt: skip
        """Say where the floor lies, about `middle` (2,), under the points `casters` (C, 3)."""
        gl = self._gl
        if "grid" in self.parts:
            self._grid.use()
            self._see(self._grid, lens, view)
            x, z = crossing(middle)
            gl.glUniform3f(self._grid.at("origin"), x, floor, z)
            gl.glUniform2f(self._grid.at("middle"), *middle)
        self._shaded = "shadow" in self.parts and len(casters) > 0
        if not self._shaded:
            return
        centre = casters[:, [0, 2]].mean(axis=0)
        dark = shadow(casters, floor, centre)
        part = darkened(dark)
        self._shaded = part is not None
        if part is None:
            return
        self._shadow.use()
        self._see(self._shadow, lens, view)
        gl.glBindTexture(gl.GL_TEXTURE_2D, self._picture)
        gl.glTexSubImage2D(
            gl.GL_TEXTURE_2D, 0, 0, 0, SHADOW_CELLS, SHADOW_CELLS, gl.GL_RED,
            gl.GL_UNSIGNED_BYTE, dark,
        )  # fmt: skip
        gl.glUniform4f(self._shadow.at("square"), centre[0], floor, centre[1], SHADOW_SPAN / 2)
        edges = (
            (edge + reach) * 2 / SHADOW_CELLS - 1
            for edge, reach in zip(part, (-1, 1, -1, 1), strict=True)
        )
        gl.glUniform4f(self._shadow.at("part"), *edges)

    def draw(self) -> None:
        """Darken the floor as it was laid."""
        gl = self._gl
        gl.glDisable(gl.GL_DEPTH_TEST)
        gl.glDisable(gl.GL_CULL_FACE)
        gl.glEnable(gl.GL_BLEND)
        gl.glBlendFuncSeparate(gl.GL_SRC_ALPHA, gl.GL_ONE_MINUS_SRC_ALPHA, gl.GL_ZERO, gl.GL_ONE)
        if "grid" in self.parts:
            self._grid.use()
            gl.glBindVertexArray(self._lines)
            gl.glDrawArrays(gl.GL_TRIANGLES, 0, self._count)
        if self._shaded:
            self._shadow.use()
            gl.glBindVertexArray(self._square)
            gl.glDrawArrays(gl.GL_TRIANGLES, 0, len(_CORNERS))
        gl.glDisable(gl.GL_BLEND)

    def _see(self, program: Program, lens: Floats, view: Floats) -> None:
        for name, matrix in (("view", view), ("lens", lens)):
            self._gl.glUniformMatrix4fv(program.at(name), 1, True, matrix)


def vertices(gl: Any, rows: Floats, widths: tuple[int, ...]) -> int:
    """A vertex array of the columns of `rows` (N, sum of widths) float32, one attribute a width."""
    array = gl.glGenVertexArrays(1)
    gl.glBindVertexArray(array)
    gl.glBindBuffer(gl.GL_ARRAY_BUFFER, gl.glGenBuffers(1))
    gl.glBufferData(gl.GL_ARRAY_BUFFER, rows.nbytes, np.ascontiguousarray(rows), gl.GL_STATIC_DRAW)
    first = 0
    for place, width in enumerate(widths):
        gl.glEnableVertexAttribArray(place)
        gl.glVertexAttribPointer(
            place, width, gl.GL_FLOAT, False, rows.shape[1] * 4, ctypes.c_void_p(4 * first)
        )
        first += width
    return int(array)


def _texture(gl: Any) -> int:
    name = gl.glGenTextures(1)
    gl.glBindTexture(gl.GL_TEXTURE_2D, name)
    for setting in (gl.GL_TEXTURE_MIN_FILTER, gl.GL_TEXTURE_MAG_FILTER):
        gl.glTexParameteri(gl.GL_TEXTURE_2D, setting, gl.GL_LINEAR)
    for setting in (gl.GL_TEXTURE_WRAP_S, gl.GL_TEXTURE_WRAP_T):
        gl.glTexParameteri(gl.GL_TEXTURE_2D, setting, gl.GL_CLAMP_TO_EDGE)
    gl.glPixelStorei(gl.GL_UNPACK_ALIGNMENT, 1)
    gl.glTexImage2D(
        gl.GL_TEXTURE_2D, 0, gl.GL_R8, SHADOW_CELLS, SHADOW_CELLS, 0, gl.GL_RED,
        gl.GL_UNSIGNED_BYTE, None,
    )  # fmt: skip
    return int(name)
