"""Reading a set's clips: decoded whole before a trial, shown by index."""

from stimuli.render.video import decode_video
from stimuli.sets.masters import read_clip

__all__ = ["decode_video", "read_clip"]
