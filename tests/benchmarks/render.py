"""Pictures: our renderer against pyrender as its examples use it, on the same walk."""

import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from tests.benchmarks.rows import row

FRAMES = 60
RUNS = 3
ROOT = Path(__file__).resolve().parents[2]
WIDTH, HEIGHT = 640, 480


def rows() -> list[dict[str, Any]]:
    """Milliseconds for one frame of a 640 × 480 picture, and of a lossless clip."""
    ours, rival = (_measured(name) for name in ("ours", "rival"))
    encoded = _measured("encoded")
    return [
        row("render one frame", ours, "ms", "pyrender: a node a part, a new scene a frame", rival,
            faster=2.0),
        row("render and encode one frame, FFV1", encoded, "ms"),
    ]  # fmt: skip


def _measured(name: str) -> float:
    """The median of several runs, each in a process of its own, as contexts must not meet."""
    from stimuli.sets.workers import ENVIRONMENT

    values = []
    for _ in range(RUNS):
        done = subprocess.run(
            [sys.executable, "-m", "tests.benchmarks.render", name],
            cwd=ROOT, env=os.environ | ENVIRONMENT, check=True, capture_output=True, text=True,
        )  # fmt: skip
        values.append(json.loads(done.stdout))
    return float(statistics.median(values))


def _walk() -> Any:
    from stimuli.motion import Motion, unroll, walker

    long, _ = unroll(walker(0), 0, FRAMES)
    return Motion(long.skeleton, long.rotations[:FRAMES], long.root[:FRAMES])


def _ours() -> Callable[[], None]:
    from stimuli.render import Appearance, group_camera
    from stimuli.render.bodies import bone_motion, make_body
    from stimuli.render.scene import Renderer

    walk, look = _walk(), Appearance(width=WIDTH, height=HEIGHT)
    body = make_body(walk)
    drawing = Renderer(look)
    drawing.show(body.skin, group_camera(body, [walk], look, FRAMES // 2))
    next(drawing.frames(bone_motion(body, walk)))

    def draw() -> None:
        for _ in drawing.frames(bone_motion(body, walk)):
            pass

    return draw


def _encoded() -> Callable[[], None]:
    from tempfile import TemporaryDirectory

    from stimuli.render import Appearance, group_camera, write_video
    from stimuli.render.bodies import bone_motion, make_body
    from stimuli.render.scene import Renderer

    walk, look = _walk(), Appearance(width=WIDTH, height=HEIGHT)
    body = make_body(walk)
    drawing = Renderer(look)
    drawing.show(body.skin, group_camera(body, [walk], look, FRAMES // 2))
    next(drawing.frames(bone_motion(body, walk)))

    def draw() -> None:
        with TemporaryDirectory() as folder:
            write_video(Path(folder) / "clip.mkv", drawing.frames(bone_motion(body, walk)), 30)

    return draw


def _rival() -> Callable[[], None]:
    """A capsule from each joint to its parent, each a node, in a scene made for each frame."""
    from stimuli.motion import forward
    from stimuli.render import Appearance, group_camera
    from stimuli.render.bodies import make_body
    from stimuli.render.reference import swing
    from stimuli.render.scene import import_pyrender

    pyrender = import_pyrender()
    import trimesh

    from stimuli.motion import quaternions as quat

    walk, look = _walk(), Appearance(width=WIDTH, height=HEIGHT, body="parts")
    camera = group_camera(make_body(walk, "parts"), [walk], look, FRAMES // 2)
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
    os.environ["PYOPENGL_PLATFORM"] = "egl"
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


PREPARED = {"ours": _ours, "encoded": _encoded, "rival": _rival}


def main(name: str) -> None:
    """Print the milliseconds of one frame."""
    draw = PREPARED[name]()
    start = time.perf_counter()
    draw()
    print((time.perf_counter() - start) * 1000 / FRAMES, flush=True)
    os._exit(0)  # the context is not worth a tidy end here


if __name__ == "__main__":
    main(sys.argv[1])
