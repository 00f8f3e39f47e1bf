"""A motion written as its file name says: BVH, or a video of it."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from stimuli.motion import Motion

MOTION_FILES = (".bvh", ".mp4", ".mkv")


def write_motion(motion: "Motion", path: Path) -> None:
    """Write a motion to a file of one of MOTION_FILES."""
    if path.suffix.lower() == ".bvh":
        from stimuli.motion.formats.bvh_write import write_bvh

        write_bvh(motion, path)
    else:
        from stimuli.render import write_clip

        write_clip(motion, path)
