"""Pictures: our renderer beside a bare moderngl program with the same triangles, and pyrender as
its examples use it, on the same walk, seen by the same camera; how large figures are in pixels.
"""

import json
import os
import statistics
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from tests.benchmarks.rows import row

FRAMES = 60
RUNS = 3
ROOT = Path(__file__).resolve().parents[2]
WIDTH, HEIGHT = 640, 480
BODY = "render one frame: skin, draw, read back"


def rows() -> list[dict[str, Any]]:
    """Milliseconds for one frame of a 640 × 480 picture, and how large the figure is in it."""
    found = measured(("ours", "moderngl", "pyrender", "grid", "dots", "encoded"))
    ours = found["ours"]
    tall, apart = _measured("pixels"), _measured("apart")
    return [
        row(BODY, ours, "ms", "moderngl, the same triangles, skinned by NumPy", found["moderngl"],
            faster=1 / 1.3),
        row(BODY, ours, "ms", "pyrender: a node a part, a new scene a frame", found["pyrender"],
            faster=1 / 0.12),
        row("the same over a grid with a shadow", found["grid"], "ms", "without ground", ours,
            faster=1 / 1.5),
        row("point lights", found["dots"], "ms", "the body", ours, faster=1 / 0.5),
        row("render and encode one frame, FFV1", found["encoded"], "ms"),
        row("a figure of 700 pixels beside one of six times the triangles, 99 %", apart,
            "levels", felt=12),
        row("standing height in pixels, of what the camera says", tall, "share", "the camera", 1.0),
    ]  # fmt: skip


def measured(names: tuple[str, ...]) -> dict[str, float]:
    """The median of several runs of each, taken in turn, so that a busy spell meets them all."""
    values: dict[str, list[float]] = {name: [] for name in names}
    for _ in range(RUNS):
        for name in names:
            values[name].append(_measured(name))
    return {name: float(statistics.median(found)) for name, found in values.items()}


def _measured(name: str) -> float:
    """One run, in a process of its own, as contexts must not meet."""
    from stimuli.sets.workers import ENVIRONMENT

    done = subprocess.run(
        [sys.executable, "-m", "tests.benchmarks.render", name],
        cwd=ROOT, env=os.environ | ENVIRONMENT, check=True, capture_output=True, text=True,
    )  # fmt: skip
    return float(json.loads(done.stdout))


def _walk() -> Any:
    from stimuli.motion import Motion, unroll, walker

    long, _ = unroll(walker(0), 0, FRAMES)
    return Motion(long.skeleton, long.rotations[:FRAMES], long.root[:FRAMES])


def _look(**settings: Any) -> Any:
    from stimuli.render import Appearance

    return replace(Appearance(width=WIDTH, height=HEIGHT, camera="fixed"), **settings)


def _camera() -> Any:
    """That of the figure, for every rival and style."""
    from stimuli.render import group_camera
    from stimuli.render.bodies import make_body

    walk = _walk()
    return group_camera(make_body(walk, _look()), [walk], _look(), FRAMES // 2)


def _drawing(**settings: Any) -> tuple[Any, Any, Any]:
    """A renderer of the walk, its bones, and its ground."""
    from stimuli.render.bodies import bone_motion, make_body
    from stimuli.render.clip import ground_motions
    from stimuli.render.scene import Renderer

    walk, look = _walk(), _look(**settings)
    body = make_body(walk, look)
    bones = bone_motion(body, walk)
    drawing = Renderer(look)
    drawing.show(body.skin, _camera())
    return drawing, bones, ground_motions(body, [walk], [bones], look)[0]


def _ours(**settings: Any) -> Callable[[], None]:
    drawing, bones, ground = _drawing(**settings)
    drawing.draw(bones, 0, ground)

    def draw() -> None:
        for _ in drawing.frames(bones, ground):
            pass

    return draw


def _encoded() -> Callable[[], None]:
    from tempfile import TemporaryDirectory

    from stimuli.render import write_video

    drawing, bones, _ = _drawing()
    drawing.draw(bones, 0)

    def draw() -> None:
        with TemporaryDirectory() as folder:
            write_video(Path(folder) / "clip.mkv", drawing.frames(bones), 30)

    return draw


VERTEX = """#version 330
in vec3 place; in vec3 normal; in float openness;
uniform mat4 whole; uniform vec3 key; uniform vec3 fill; uniform vec3 colour;
centroid out vec3 shown;
SHADE
void main() {
    gl_Position = whole * vec4(place, 1.0);
    shown = colour * shade(normal, openness, key, fill);
}
"""
FRAGMENT = """#version 330
centroid in vec3 shown; out vec4 colour;
void main() { colour = vec4(shown, 1.0); }
"""


def _moderngl() -> Callable[[], None]:
    """The same skin, moved by NumPy, drawn whole and read back whole."""
    import moderngl

    from stimuli.render.bodies import bone_motion, make_body
    from stimuli.render.light import FILL, KEY, SHADE, towards
    from stimuli.render.rig import moved
    from stimuli.render.scene import in_order, projection

    walk, look, camera = _walk(), _look(), _camera()
    body = make_body(walk, look)
    skin, bones = body.skin, bone_motion(body, walk)
    context = moderngl.create_standalone_context(backend="egl")
    context.enable(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
    program = context.program(VERTEX.replace("SHADE", SHADE), FRAGMENT)
    lens = projection(camera.field_of_view, WIDTH / HEIGHT) @ np.linalg.inv(camera.pose)
    program["whole"].write(lens.T.astype("f4").tobytes())
    for name, value in (("key", towards(KEY, camera.axes)), ("fill", towards(FILL, camera.axes))):
        program[name].write(value.astype("f4").tobytes())
    program["colour"].write(np.array(look.colour, "f4").tobytes())
    rows = np.zeros((len(skin.points), 7), np.float32)
    rows[:, 6] = skin.openness
    buffer = context.buffer(rows.tobytes(), dynamic=True)
    index = context.buffer(in_order(skin.faces).tobytes())
    array = context.vertex_array(
        program, [(buffer, "3f 3f 1f", "place", "normal", "openness")], index
    )
    size = (WIDTH, HEIGHT)
    many = context.framebuffer(
        context.renderbuffer(size, samples=4), context.depth_renderbuffer(size, samples=4)
    )
    one = context.framebuffer(context.renderbuffer(size))

    def draw() -> None:
        for frame in bones:
            rows[:, :3], rows[:, 3:6] = moved(skin.weights, frame, skin.points, skin.normals)
            buffer.write(rows)
            many.use()
            context.clear(*look.background)
            array.render()
            context.copy_framebuffer(one, many)
            np.frombuffer(one.read(components=3), np.uint8).reshape(HEIGHT, WIDTH, 3)[::-1].copy()

    draw()
    return draw


def import_pyrender() -> Any:
    """pyrender for EGL, without the warnings of its imports."""
    os.environ["PYOPENGL_PLATFORM"] = "egl"
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", category=DeprecationWarning, module=r"(OpenGL|pyrender)")
        import pyrender
    return pyrender


def _pyrender() -> Callable[[], None]:
    """A capsule from each joint to its parent, each a node, in a scene made for each frame."""
    from stimuli.motion import forward
    from stimuli.motion import quaternions as quat
    from stimuli.render.reference import swing

    pyrender = import_pyrender()
    import trimesh

    walk, look, camera = _walk(), _look(), _camera()
    positions, _ = forward(walk.skeleton, walk.rotations, walk.root)
    up = np.array([0.0, 0.0, 1.0])
    axes = np.eye(3)
    bones = [(j, int(p)) for j, p in enumerate(walk.skeleton.parents) if p >= 0]
    lengths = {
        bone: np.linalg.norm(positions[0, bone[0]] - positions[0, bone[1]]) for bone in bones
    }
    capsules = {
        bone: trimesh.creation.capsule(length, 0.05, count=[24, 24])
        for bone, length in lengths.items()
    }
    offscreen = pyrender.OffscreenRenderer(WIDTH, HEIGHT)

    def picture(frame: int) -> None:
        scene = pyrender.Scene(bg_color=(*look.background, 1.0), ambient_light=(0.3, 0.3, 0.3))
        for joint, parent in bones:
            pose = np.eye(4)
            turn = swing(up, positions[frame, joint] - positions[frame, parent])
            pose[:3, :3] = quat.rotate(turn, axes).T
            pose[:3, 3] = positions[frame, parent]
            scene.add(pyrender.Mesh.from_trimesh(capsules[joint, parent]), pose=pose)
        scene.add(pyrender.DirectionalLight(np.ones(3), 3.0), pose=camera.pose)
        scene.add(pyrender.PerspectiveCamera(camera.field_of_view), pose=camera.pose)
        offscreen.render(scene)

    picture(0)

    def draw() -> None:
        for frame in range(FRAMES):
            picture(frame)

    return draw


def pixels() -> float:
    """Height in pixels of a body that stands where the walk begins, as a share of `size_of`."""
    from stimuli.render.bodies import bone_motion, make_body
    from stimuli.render.scene import Renderer

    walk, look, camera = _walk(), _look(), _camera()
    body = make_body(walk, look)
    still = np.zeros((1, *bone_motion(body, walk).shape[1:]), np.float32)
    still[..., 0] = 1.0
    still[..., 5:] = walk.root[0] / 2
    drawing = Renderer(look)
    drawing.show(body.skin, camera)
    picture = drawing.draw(still, 0)
    tall = np.flatnonzero(np.any(picture != picture[0, 0], axis=(1, 2)))
    said = float(camera.size_of(body.stature, walk.root[0]))
    return float(np.ptp(tall) + 1) / HEIGHT / said


def apart() -> float:
    """Grey levels by which 99 % of a figure differ, at most, from one of very small triangles."""
    from stimuli.render import field, group_camera
    from stimuli.render.bodies import bone_motion, make_body
    from stimuli.render.scene import Renderer

    look = _look(width=0, height=720, shape="16:9", camera="follow")
    walk = _walk()
    body = make_body(walk, look)
    with patch.object(field, "CELL", FINE), patch.object(field, "_SPLITS", 0):
        fine = make_body(walk, look)
    assert len(fine.skin.faces) > 6 * len(body.skin.faces)
    bones, drawing, levels = bone_motion(body, walk), Renderer(look), []
    for direction in (0.0, 40.0, 90.0, 180.0):
        turned = replace(drawing.look, direction=direction)
        camera = group_camera(body, [walk], turned, FRAMES // 2)
        pair = []
        for skin in (body.skin, fine.skin):
            drawing.show(skin, camera)
            pair.append(np.stack([drawing.draw(bones, n).astype(int) for n in (10, 25, 40)]))
        shown = np.any((pair[0] != 128) | (pair[1] != 128), axis=-1)
        levels.append(np.abs(pair[0] - pair[1]).max(axis=-1)[shown])
    return float(np.percentile(np.concatenate(levels), 99))


FINE = 0.0055  # of the height: a cell of the finer body


PREPARED = {
    "ours": _ours,
    "moderngl": _moderngl,
    "pyrender": _pyrender,
    "grid": lambda: _ours(ground="grid"),
    "dots": lambda: _ours(style="point-light"),
    "encoded": _encoded,
}


TOLD = {"pixels": pixels, "apart": apart}


def main(name: str) -> None:
    """Print the milliseconds of one frame, or what else is asked for."""
    if name in TOLD:
        print(TOLD[name](), flush=True)
        os._exit(0)
    draw = PREPARED[name]()
    start = time.perf_counter()
    draw()
    print((time.perf_counter() - start) * 1000 / FRAMES, flush=True)
    os._exit(0)  # the context is not worth a tidy end here


if __name__ == "__main__":
    main(sys.argv[1])
