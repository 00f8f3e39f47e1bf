"""A blend schedule of its own for every joint (Wang 2005, V.1.4), to show how that fails.

Each weighted joint blends over the length that its own distances ask for, centred in the window of
the longest; joints below take the schedule of the nearest weighted one above them, the rest and
the root that of the whole window.
"""

import numpy as np

from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion, Skeleton
from stimuli.ties import first_least
from stimuli.transition.blend import blend_weighted, smoothstep
from stimuli.transition.curves import joint_curves
from stimuli.transition.join import Join, Joined
from stimuli.transition.length import Length, no_room
from stimuli.transition.window import Window


def length_per_joint(a: Motion, b: Motion, i: int, j: int, specification: str) -> Length:
    """The longest of the lengths at which the weighted joints differ least, each alone."""
    curves = joint_curves(a, b, i, j, specification)
    if any(np.all(np.isnan(curve)) for curve in curves.values()):
        raise no_room(i, j)
    schedule = {role: first_least(curve) + 1 for role, curve in curves.items()}
    return Length(max(schedule.values()), {"schedule": schedule})


def given_per_joint(
    a: Motion, b: Motion, i: int, j: int, specification: str, frames: int
) -> Length:
    """The same schedule, stretched so that the longest blend lasts as long as is wanted."""
    own = length_per_joint(a, b, i, j, specification)
    stretch = frames / own.frames
    schedule = {
        role: max(int(np.floor(length * stretch + 0.5)), 1)
        for role, length in own.report["schedule"].items()
    }
    return Length(frames, {"given": True, "schedule": schedule})


def join_per_joint(join: Join) -> Joined:
    """Slerp over one window with weights that rise at each joint's own slope."""
    window = join.fitting_window()
    frames = _frames_of(join.a.skeleton, join.length.report["schedule"], window.frames)
    weights = np.stack([_centred(window, int(length)) for length in frames], axis=-1)
    weights = smoothstep(weights) if join.smooth else weights
    motion = blend_weighted(join.a, join.brought(window), window, weights)
    return Joined(motion, (window.first, window.last))


def _frames_of(skeleton: Skeleton, schedule: dict[str, int], default: int) -> np.ndarray:
    """Blend length (J,) of every joint: its own, or that of the nearest scheduled one above."""
    own = {skeleton.roles[role]: length for role, length in schedule.items()}
    frames = np.full(len(skeleton), default)
    for joint, parent in enumerate(skeleton.parents):
        if joint in own:
            frames[joint] = own[joint]
        elif parent > 0:
            frames[joint] = frames[parent]
    return frames


def _centred(window: Window, frames: int) -> Array:
    """Weights (N,) of a blend of so many frames in the middle of the window."""
    slope = (window.frames + 1) / (frames + 1)
    return np.asarray(np.clip(0.5 + slope * (window.weights - 0.5), 0.0, 1.0))
