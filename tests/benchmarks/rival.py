"""Pictures of a motion as pyrender's examples draw: what people write who do not have Segue."""

import os
import warnings
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

WIDTH, HEIGHT = 640, 480


def straightforward() -> Callable[[Any, Any], Iterator[Any]]:
    """Pictures (height, width, 3) of a motion seen by a camera, where it is in each frame.

    A capsule from each joint to its parent, each a node, in a scene made for each frame.
    """
    from stimuli.motion import forward
    from stimuli.motion import quaternions as quat
    from stimuli.render.reference import swing

    os.environ["PYOPENGL_PLATFORM"] = "egl"
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", category=DeprecationWarning, module=r"(OpenGL|pyrender)")
        import pyrender
    import trimesh

    offscreen = pyrender.OffscreenRenderer(WIDTH, HEIGHT)
    up, axes = np.array([0.0, 0.0, 1.0]), np.eye(3)

    def pictures(motion: Any, camera: Any) -> Iterator[Any]:
        positions, _ = forward(motion.skeleton, motion.rotations, motion.root)
        bones = [(j, int(p)) for j, p in enumerate(motion.skeleton.parents) if p >= 0]
        capsules = {
            (j, p): trimesh.creation.capsule(
                np.linalg.norm(positions[0, j] - positions[0, p]), 0.05, count=[24, 24]
            )
            for j, p in bones
        }
        for frame, at in enumerate(positions):
            pose_of_camera = camera.at(frame).pose
            scene = pyrender.Scene(bg_color=(0.5, 0.5, 0.5, 1.0), ambient_light=(0.3, 0.3, 0.3))
            for joint, parent in bones:
                pose = np.eye(4)
                pose[:3, :3] = quat.rotate(swing(up, at[joint] - at[parent]), axes).T
                pose[:3, 3] = at[parent]
                scene.add(pyrender.Mesh.from_trimesh(capsules[joint, parent]), pose=pose)
            scene.add(pyrender.DirectionalLight(np.ones(3), 3.0), pose=pose_of_camera)
            scene.add(pyrender.PerspectiveCamera(camera.field_of_view), pose=pose_of_camera)
            yield offscreen.render(scene)[0]

    return pictures
