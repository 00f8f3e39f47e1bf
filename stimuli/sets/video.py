"""Reading a set's clips: decoded whole before a trial, shown by index."""

from stimuli.render.video import decode_video

__all__ = ["decode_video"]
