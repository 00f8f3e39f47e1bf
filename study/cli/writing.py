"""A motion written as its file name says: BVH, a video of it, a figure as glTF."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from stimuli.motion import Motion

MOTION_FILES = (".bvh", ".mp4", ".mov", ".mkv", ".glb")


def write_motion(motion: "Motion", path: Path) -> None:
    """Write a motion to a file of one of MOTION_FILES."""
    {".bvh": _write_bvh, ".glb": _write_figure}.get(path.suffix.lower(), _write_video)(motion, path)


def _write_bvh(motion: "Motion", path: Path) -> None:
    from stimuli.motion.formats.bvh_write import write_bvh

    write_bvh(motion, path)


def _write_video(motion: "Motion", path: Path) -> None:
    from stimuli.render import write_clip

    write_clip(motion, path)


def _write_figure(motion: "Motion", path: Path) -> None:
    from stimuli.render import Appearance
    from stimuli.render.bodies import bone_motion, make_body
    from stimuli.render.gltf import write_glb

    look = Appearance()
    body = make_body(motion, look)
    write_glb(path, body, bone_motion(body, motion), motion.fps, look.colour)
