"""Drawing one figure offscreen, frame after frame, through pyrender and EGL.

The figure is a single mesh whose vertex buffer is rewritten in place for each frame: one draw
call, and the same bytes on every run. Only the part of the picture that the figure covers is
cleared, resolved and read back; the rest is background. Depth is never read.

One renderer a process; close it before the process ends.
"""

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stimuli.errors import InputError, MachineError
from stimuli.render.appearance import Appearance
from stimuli.render.bodies import Skin
from stimuli.render.camera import Camera
from stimuli.render.device import driver, open_platform
from stimuli.render.light import shade
from stimuli.render.rig import moved
from stimuli.render.shapes import Floats
from stimuli.render.video import Pictures

GRAPHICS = (
    "install libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri (Debian; it needs no screen and no card), "
    "or render on another machine and bring the set over"
)
NEAR, _FAR = 0.05, 200.0
BORDER = 2  # pixels around the figure's box, for its antialiased edge


class Renderer:
    """An offscreen context for pictures of one look; `show` says of which body, from where."""

    def __init__(self, look: Appearance, device: str = "auto") -> None:
        self.look = look
        self._pyrender, self._platform = _opened(look, device)
        self.driver = driver()
        pyrender = self._pyrender
        self._drawing = _drawing(pyrender)(look.width, look.height)
        self._flags = pyrender.RenderFlags.FLAT | pyrender.RenderFlags.OFFSCREEN
        self._background = np.empty((look.height, look.width, 3), dtype=np.uint8)
        self._background[:] = np.rint(np.array(look.background) * 255)
        self._tint = np.array(look.colour, dtype=np.float32)

    def show(self, skin: Skin, camera: Camera) -> None:
        """Draw this skin, seen by this camera, from now on."""
        self.skin, self.camera = skin, camera
        self._scene, self._primitive = _scene(self._pyrender, skin, camera, self.look)
        self._buffer = np.ones((len(skin.points), 7), dtype=np.float32)
        self._drawing._update_context(self._scene, self._flags)

    def frames(self, bone_motion: NDArray[np.float32]) -> Iterator[Pictures]:
        """A picture (height, width, 3) RGB for each frame of the bones' motion (F, B, 8)."""
        skin = self.skin
        for bones in bone_motion:
            yield self.draw(*moved(skin.weights, bones, skin.points, skin.normals))

    def draw(self, points: Floats, normals: Floats) -> Pictures:
        """One picture (height, width, 3) of the skin at `points` with `normals` (V, 3)."""
        from OpenGL import GL

        buffer = self._buffer
        buffer[:, :3] = points
        buffer[:, 3:6] = shade(normals, self.skin.openness, self.camera.axes)[:, None] * self._tint
        GL.glBindBuffer(GL.GL_ARRAY_BUFFER, self._primitive._buffers[0])
        GL.glBufferSubData(GL.GL_ARRAY_BUFFER, 0, buffer.nbytes, buffer)
        picture = self._background.copy()
        left, top, right, bottom = self._box(points)
        if left < right and top < bottom:
            box = (left, self.look.height - bottom, right - left, bottom - top)
            self._drawing.box = box
            GL.glEnable(GL.GL_SCISSOR_TEST)
            GL.glScissor(*box)
            picture[top:bottom, left:right] = self._drawing.render(self._scene, self._flags)
        return picture

    def _box(self, points: Floats) -> tuple[int, int, int, int]:
        """Left, top, right and bottom pixels of the box around the figure, within the picture."""
        size = np.array([self.look.width, self.look.height])
        pixels, _ = self.camera.project(points, self.look.width, self.look.height)
        low = np.clip(np.floor(pixels.min(axis=0)) - BORDER, 0, size).astype(int)
        high = np.clip(np.ceil(pixels.max(axis=0)) + BORDER, 0, size).astype(int)
        return int(low[0]), int(low[1]), int(high[0]), int(high[1])

    def close(self) -> None:
        """Free the context; it must not outlive its process."""
        if self._platform is not None:
            if self._drawing.figure_program is not None:
                self._drawing.figure_program.delete()
            self._drawing.delete()
            self._platform.delete_context()
            self._platform = None


def _opened(look: Appearance, device: str) -> tuple[Any, Any]:
    """pyrender and a current context of its; MachineError where the machine has no OpenGL."""
    try:
        pyrender = import_pyrender()
        platform = open_platform(device, look.width, look.height)
    except InputError:
        raise
    except Exception as error:  # each driver and binding fails in a way of its own
        why = " ".join(str(error).split()) or type(error).__name__
        raise MachineError(
            f"rendering: expected a device for OpenGL by EGL, found none ({why});\n{GRAPHICS}"
        ) from error
    return pyrender, platform


@contextmanager
def renderer(look: Appearance) -> Iterator[Renderer]:
    """A renderer that is closed whatever happens."""
    drawing = Renderer(look)
    try:
        yield drawing
    finally:
        drawing.close()


def import_pyrender() -> Any:
    """pyrender for EGL, without the warnings of its imports.

    The platform is chosen by an environment variable that PyOpenGL reads when it is imported.
    """
    os.environ["PYOPENGL_PLATFORM"] = "egl"
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", category=DeprecationWarning, module=r"(OpenGL|pyrender)")
        import pyrender
    return pyrender


def _scene(pyrender: Any, skin: Skin, camera: Camera, look: Appearance) -> tuple[Any, Any]:
    """A scene of the skin's mesh and the camera; the mesh's one primitive."""
    primitive = pyrender.Primitive(
        positions=skin.points,
        color_0=np.ones((len(skin.points), 4), dtype=np.float32),
        indices=skin.faces.astype(np.uint32),
        material=pyrender.MetallicRoughnessMaterial(baseColorFactor=(1.0, 1.0, 1.0, 1.0)),
    )
    scene = pyrender.Scene(bg_color=(*look.background, 1.0))
    scene.add(pyrender.Mesh([primitive]))
    lens = pyrender.PerspectiveCamera(camera.field_of_view, znear=NEAR, zfar=_FAR)
    scene.add(lens, pose=camera.pose)
    return scene, primitive


VERTEX = """#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 colour;
uniform mat4 V;
uniform mat4 P;
centroid out vec4 shown;
void main() { gl_Position = P * V * vec4(position, 1.0); shown = colour; }
"""
FRAGMENT = """#version 330 core
centroid in vec4 shown;
out vec4 frag_color;
void main() { frag_color = shown; }
"""


def _program() -> Any:
    """A shader program that shows the vertices' colours.

    They are interpolated at centroids: at the middle of a pixel that a triangle only touches they
    would be extrapolated, and speckle the figure's outline.
    """
    from pyrender.shader_program import ShaderProgram

    with TemporaryDirectory(prefix="segue-") as folder:
        vertex, fragment = Path(folder, "figure.vert"), Path(folder, "figure.frag")
        vertex.write_text(VERTEX, encoding="utf-8")
        fragment.write_text(FRAGMENT, encoding="utf-8")
        program = ShaderProgram(str(vertex), str(fragment))
        program._add_to_context()
    return program


def _drawing(pyrender: Any) -> Any:
    """pyrender's renderer with a program of our own, reading back only the colours in `box`."""
    from OpenGL import GL
    from pyrender.renderer import Renderer as Base

    class Drawing(Base):
        box: tuple[int, int, int, int]
        figure_program: Any = None

        def _get_primitive_program(self, primitive: Any, flags: int, uses: int) -> Any:
            self.figure_program = self.figure_program or _program()
            return self.figure_program

        def _read_main_framebuffer(self, scene: Any, flags: int) -> Pictures:
            x, y, width, height = self.box
            corners = (x, y, x + width, y + height)
            GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, self._main_fb_ms)
            GL.glBindFramebuffer(GL.GL_DRAW_FRAMEBUFFER, self._main_fb)
            GL.glBlitFramebuffer(*corners, *corners, GL.GL_COLOR_BUFFER_BIT, GL.GL_NEAREST)
            GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, self._main_fb)
            raw = GL.glReadPixels(*self.box, GL.GL_RGBA, GL.GL_UNSIGNED_BYTE)
            pixels = np.frombuffer(raw, dtype=np.uint8).reshape(height, width, 4)
            return pixels[::-1, :, :3]

    return Drawing
