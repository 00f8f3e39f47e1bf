"""Drawing one figure offscreen, frame after frame, through OpenGL and EGL.

The skin lies on the card (or in the software that stands in for one) from the first frame on, and
its bones alone are sent for each: it is moved and lit there. Faces that look away are not drawn.
Only the boxes of the picture that the figure and its ground cover are cleared and read back; the
rest is background. The ground lies in a box of its own, of one sample a pixel, since it fades by
itself; it is drawn once more behind the figure. Depth is never read.

One renderer a process; close it before the process ends.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from stimuli.errors import InputError
from stimuli.render.appearance import Appearance
from stimuli.render.camera import Camera
from stimuli.render.context import EglContext, import_gl
from stimuli.render.device import driver
from stimuli.render.floor import Floor, vertices
from stimuli.render.ground import GROUNDS, GroundMotion
from stimuli.render.light import FILL, KEY, tinted, towards
from stimuli.render.programs import INFLUENCES, SKIN_FRAGMENT, SKIN_VERTEX, Program
from stimuli.render.rig import moved
from stimuli.render.shapes import Floats
from stimuli.render.skin import BETWEEN, Skin
from stimuli.render.target import EDGE_SAMPLES, Box, Target
from stimuli.render.video import Pictures

NEAR, FAR = 0.25, 200.0
BORDER = 3  # pixels around the figure's box, for its antialiased edge
STILL: NDArray[np.float32] = np.zeros((0, 3), dtype=np.float32)


class Renderer:
    """An offscreen context for pictures of one look; `show` says of which body, from where."""

    def __init__(self, look: Appearance, device: str = "auto") -> None:
        if look.ground not in GROUNDS:
            raise InputError(
                f"ground: expected one of {', '.join(GROUNDS)}, found {look.ground!r}."
            )
        self.look = look if look.width else look.shaped("16:9")
        look = self.look
        self._context = EglContext(device)
        self._gl = import_gl()
        self.driver = driver(self._gl)
        size = (look.width, look.height, look.supersample)
        self._target = Target(self._gl, *size, EDGE_SAMPLES)
        self._flat = Target(self._gl, *size, 1)
        levels = np.rint(np.array(look.background) * 255).astype(np.uint8)
        self._background = np.empty((look.height, look.width, 3), dtype=np.uint8)
        self._background[:] = levels
        red, green, blue = (float(level) / 255 for level in levels)
        self._behind = (red, green, blue)
        self._floor = Floor(self._gl, look)
        self._programs: dict[int, Program] = {}

    def show(self, skin: Skin, camera: Camera) -> None:
        """Draw this skin, seen by this camera, from now on."""
        gl, look = self._gl, self.look
        self.skin, self.camera = skin, camera
        far = skin.outermost
        self._outline = tuple(a[far] for a in (skin.weights, skin.points, skin.normals))
        bones = skin.weights.shape[1]
        if bones not in self._programs:
            vertex = SKIN_VERTEX.replace("[BONES]", f"[{2 * bones}]")
            self._programs[bones] = Program(gl, vertex, SKIN_FRAGMENT)
        self._program = self._programs[bones]
        self._array = vertices(gl, _attributes(skin, look), (3, 4, 3, 2, 3, 3, 3, 3))
        faces = in_order(skin.faces)
        gl.glBindBuffer(gl.GL_ELEMENT_ARRAY_BUFFER, gl.glGenBuffers(1))
        gl.glBufferData(gl.GL_ELEMENT_ARRAY_BUFFER, faces.nbytes, faces, gl.GL_STATIC_DRAW)
        self._lens = projection(camera.field_of_view, look.width / look.height)
        self._rim = _radius(look, camera.field_of_view)

    def frames(
        self, bone_motion: NDArray[np.float32], ground: GroundMotion | None = None
    ) -> Iterator[Pictures]:
        """A picture (height, width, 3) RGB for each frame of the bones' motion (F, B, 8)."""
        for frame in range(len(bone_motion)):
            yield self.draw(bone_motion, frame, ground)

    def draw(
        self, bone_motion: NDArray[np.float32], frame: int, ground: GroundMotion | None = None
    ) -> Pictures:
        """The picture (height, width, 3) of one frame."""
        camera, bones = self.camera.at(frame), bone_motion[frame]
        points, _ = moved(self._outline[0], bones, *self._outline[1:])
        box = self._box(camera, points, BETWEEN + self._rim[0])
        picture = self._background.copy()
        view = np.linalg.inv(camera.pose).astype(np.float32)
        laid = ground if self._floor.parts else None
        if laid is not None:
            casters = laid.casters[frame]
            reach = self._floor.reach(casters, laid.floor, laid.middles[frame])
            under = casters if self.skin.lit else STILL
            self._floor.lay(self._lens, view, under, laid.floor, laid.middles[frame])
            self._put(picture, self._flat, self._box(camera, reach, 0.0), self._floor.draw)

        def behind_and_skin() -> None:
            if laid is not None:
                self._floor.draw()
            self._draw_skin(camera, view, bones)

        self._put(picture, self._target, box, behind_and_skin)
        return picture

    def _put(self, picture: Pictures, target: Target, box: Box, draw: Callable[[], None]) -> None:
        """Put what is drawn there into a box of the picture."""
        if not box.empty:
            target.begin(box, self._behind)
            draw()
            picture[box.top : box.bottom, box.left : box.right] = target.pixels()

    def _draw_skin(self, camera: Camera, view: Floats, bones: NDArray[np.float32]) -> None:
        gl, program = self._gl, self._program
        gl.glEnable(gl.GL_DEPTH_TEST)
        (gl.glEnable if self.skin.lit else gl.glDisable)(gl.GL_CULL_FACE)
        program.use()
        gl.glUniformMatrix4fv(program.at("view"), 1, True, view)
        gl.glUniformMatrix4fv(program.at("lens"), 1, True, self._lens)
        for name, light in (("key", KEY), ("fill", FILL)):
            gl.glUniform3f(program.at(name), *towards(light, camera.axes))
        gl.glUniform1f(program.at("lit"), float(self.skin.lit))
        gl.glUniform2f(program.at("disc"), *self._rim)
        gl.glUniform4fv(program.at("bones"), 2 * len(bones), np.ascontiguousarray(bones))
        gl.glBindVertexArray(self._array)
        gl.glDrawElements(gl.GL_TRIANGLES, self.skin.faces.size, gl.GL_UNSIGNED_INT, None)

    def _box(self, camera: Camera, points: Floats, radius: float) -> Box:
        """The box about balls at `points`, in the picture."""
        width, height = self.look.width, self.look.height
        size = np.array([width, height])
        pixels, depth = camera.project(points, width, height)
        if depth.min() < NEAR:
            return Box(0, 0, width, height)
        focal = height / 2 / np.tan(camera.field_of_view / 2)
        room = BORDER + focal * (radius / depth[:, None] + self._rim[1])
        low = np.clip(np.floor((pixels - room).min(axis=0)), 0, size).astype(int)
        high = np.clip(np.ceil((pixels + room).max(axis=0)), 0, size).astype(int)
        return Box(int(low[0]), int(low[1]), int(high[0]), int(high[1]))

    def close(self) -> None:
        """Free the context; it must not outlive its process."""
        self._context.close()


@contextmanager
def renderer(look: Appearance) -> Iterator[Renderer]:
    """A renderer that is closed whatever happens."""
    drawing = Renderer(look)
    try:
        yield drawing
    finally:
        drawing.close()


def in_order(faces: NDArray[np.int32]) -> NDArray[np.uint32]:
    """(T, 3) faces so that those with a point in common are near each other.

    A point is moved and lit anew for each batch of faces that has it: in any order, many times.
    """
    order = np.argsort(faces.min(axis=1), kind="stable")
    return np.ascontiguousarray(faces[order], dtype=np.uint32)


def _attributes(skin: Skin, look: Appearance) -> NDArray[np.float32]:
    """(V, 24) what each point has: see the skin's program."""
    count = len(skin.points)
    carried = min(INFLUENCES, skin.weights.shape[1])
    order = np.argsort(-skin.weights, axis=1, kind="stable")[:, :carried]
    weights, indices = np.zeros((2, count, INFLUENCES))
    weights[:, :carried] = np.take_along_axis(skin.weights, order, axis=1)
    indices[:, :carried] = order
    rims = skin.rims if len(skin.rims) else np.zeros((count, 2))
    half = INFLUENCES // 2
    return np.concatenate(
        [
            skin.points, skin.normals, skin.openness[:, None],
            tinted(look.colour, skin.sides, look.tint), rims,
            weights[:, :half], indices[:, :half], weights[:, half:], indices[:, half:],
        ],
        axis=1,
    ).astype(np.float32)  # fmt: skip


def projection(field_of_view: float, aspect: float) -> NDArray[np.float32]:
    """(4, 4) the projection of a camera."""
    focal = 1 / np.tan(field_of_view / 2)
    span = NEAR - FAR
    return np.array(
        [
            [focal / aspect, 0, 0, 0], [0, focal, 0, 0],
            [0, 0, (FAR + NEAR) / span, 2 * FAR * NEAR / span], [0, 0, -1, 0],
        ],
        dtype=np.float32,
    )  # fmt: skip


def _radius(look: Appearance, field_of_view: float) -> tuple[float, float]:
    """A dot's radius in metres, and in metres for each metre from the camera.

    A dot of so many degrees has that share of the picture's height, on a flat screen.
    """
    if look.style != "point-light":
        return 0.0, 0.0
    if look.dot_unit == "metres":
        return look.dot_size / 2, 0.0
    share = np.tan(np.radians(look.dot_size / 2)) / np.tan(np.radians(look.picture_degrees / 2))
    return 0.0, float(share * np.tan(field_of_view / 2))
