"""From a motion to pictures: the body, the camera that holds it, its ground, the file."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stimuli.motion.skeleton import Motion
from stimuli.render.appearance import Appearance
from stimuli.render.bodies import Body, bone_motion, make_body, rig_motion
from stimuli.render.camera import Camera
from stimuli.render.ground import GroundMotion
from stimuli.render.rig import moved
from stimuli.render.shapes import Floats
from stimuli.render.staging import choose_camera, settle, smoothed, stage
from stimuli.render.video import Pictures, write_video

FLOOR_SHARE = 25  # percent of frames in which the lowest foot is lower than the floor


def group_camera(
    body: Body,
    motions: Sequence[Motion],
    look: Appearance,
    at: int,
    mixed: Sequence[tuple[int, int]] | None = None,
) -> Camera:
    """The camera that holds the body in every frame of every motion of a group.

    Its angles count from the heading of the first motion at frame `at`, the transition; `mixed`
    are the frames that the blend mixes in each motion.
    """
    staging = stage(body, motions, [bone_motion(body, m) for m in motions], at, mixed)
    if look.settled:
        return choose_camera(staging, look)
    return settle(look, [staging]).cameras[0]


def caster_motion(body: Body, bones: Floats) -> NDArray[np.float32]:
    """(F, C, 3) where the points of the body are that darken the ground under them.

    `bones` (F, B, 8) are those of the rig.
    """
    none = np.zeros_like(body.casters)
    places = [moved(body.casting, moves, body.casters, none)[0] for moves in bones]
    return np.array(places, dtype=np.float32)


def floor_of(casters: Sequence[NDArray[np.float32]]) -> float:
    """Height of the floor (m) under bodies whose lowest points stand on it now and then."""
    lowest = np.concatenate([places[..., 1].min(axis=1) for places in casters])
    return round(float(np.percentile(lowest, FLOOR_SHARE)), 4)


def ground_motions(
    body: Body, motions: Sequence[Motion], bones: Sequence[NDArray[np.float32]], look: Appearance
) -> list[GroundMotion | None]:
    """What the ground of each motion of a group is drawn by; nothing where the look has none.

    `bones` are what carries the skin in each.
    """
    if look.ground == "none":
        return [None for _ in motions]
    rigs = bones if body.skin.lit else [rig_motion(body, motion) for motion in motions]
    casters = [caster_motion(body, moves) for moves in rigs]
    floor = floor_of(casters)
    middle = smoothed(
        np.mean([motion.root[:, [0, 2]] for motion in motions], axis=0), round(motions[0].fps)
    )
    return [GroundMotion(places, middle, floor) for places in casters]


def render_frames(
    motion: Motion,
    look: Appearance,
    *,
    body: Body | None = None,
    camera: Camera | None = None,
    middle: int | None = None,
) -> Iterator[Pictures]:
    """Each frame of a motion as (height, width, 3) RGB, the transition being at frame `middle`."""
    from stimuli.render.scene import renderer

    body = body or make_body(motion, look)
    at = len(motion) // 2 if middle is None else middle
    bones = bone_motion(body, motion)
    if camera is None or not look.settled:
        settled = settle(look, [stage(body, [motion], [bones], at)])
        look, camera = settled.look, camera or settled.cameras[0]
    ground = ground_motions(body, [motion], [bones], look)[0]
    with renderer(look) as drawing:
        drawing.show(body.skin, camera)
        yield from drawing.frames(bones, ground)


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
