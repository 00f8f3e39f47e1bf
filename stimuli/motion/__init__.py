"""Captured motion: skeletons, rotations, file formats, resampling, the motion library.

A `Clip` is one file brought to Segue's conventions: metres, +Y up, 30 frames a second, unit
quaternions (w, x, y, z), joints known by their anatomical roles. Everything here is plain NumPy.
"""

from stimuli.motion.clip import Clip, load_clip
from stimuli.motion.kinematics import end_positions, forward, heading
from stimuli.motion.library import Library, motion_directories, user_library
from stimuli.motion.loops import unroll
from stimuli.motion.samples import fetch
from stimuli.motion.skeleton import Cycle, Motion, Skeleton
from stimuli.motion.walker import walker, write_walker

__all__ = [
    "Clip",
    "Cycle",
    "Library",
    "Motion",
    "Skeleton",
    "end_positions",
    "fetch",
    "forward",
    "heading",
    "load_clip",
    "motion_directories",
    "unroll",
    "user_library",
    "walker",
    "write_walker",
]
