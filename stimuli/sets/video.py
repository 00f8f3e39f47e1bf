"""Reading a set's clips: decoded whole before a trial, shown by index."""

from stimuli.render.video import decode

__all__ = ["decode"]
