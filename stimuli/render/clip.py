"""From a motion to pictures: the body, the camera that holds it, the file."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from stimuli.motion.kinematics import headings
from stimuli.motion.skeleton import Motion
from stimuli.render.appearance import Appearance
from stimuli.render.bodies import Body, bone_motion, make_body
from stimuli.render.camera import Camera, choose_camera
from stimuli.render.rig import moved
from stimuli.render.shapes import Floats
from stimuli.render.video import Pictures, write_video

EVERY = 23  # one vertex in so many is enough to know how far a body reaches
SKIN = 0.02  # metres, what the vertices between those may reach further


def group_camera(body: Body, motions: Sequence[Motion], look: Appearance, at: int) -> Camera:
    """The camera that holds the body in every frame of every motion of a group.

    Its angles count from the heading of the first motion at frame `at`, the transition.
    """
    reach = np.concatenate([outline(body, motion) for motion in motions])
    facing = float(headings(motions[0][at : at + 1])[0])
    return choose_camera(reach, facing, motions[0].root[at], look, SKIN)


def outline(body: Body, motion: Motion) -> Floats:
    """(N, 3) points of the moving skin that tell how far it reaches."""
    weights, points, normals = (
        array[::EVERY] for array in (body.skin.weights, body.skin.points, body.skin.normals)
    )
    places = [moved(weights, bones, points, normals)[0] for bones in bone_motion(body, motion)]
    return np.concatenate(places)


def render_frames(
    motion: Motion,
    look: Appearance,
    *,
    body: Body | None = None,
    camera: Camera | None = None,
    middle: int | None = None,
) -> Iterator[Pictures]:
    """Each frame of a motion as (height, width, 3) RGB, seen three-quarter at frame `middle`."""
    from stimuli.render.scene import renderer

    body = body or make_body(motion, look.body)
    at = len(motion) // 2 if middle is None else middle
    camera = camera or group_camera(body, [motion], look, at)
    with renderer(look) as drawing:
        drawing.show(body.skin, camera)
        yield from drawing.frames(bone_motion(body, motion))


def write_clip(
    motion: Motion,
    path: Path,
    look: Appearance | None = None,
    *,
    body: Body | None = None,
    camera: Camera | None = None,
    middle: int | None = None,
) -> int:
    """Render a motion to `path` (.mkv lossless, .mp4 for looking at); returns how many frames."""
    frames = render_frames(motion, look or Appearance(), body=body, camera=camera, middle=middle)
    return write_video(path, frames, motion.fps)
