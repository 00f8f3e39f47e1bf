"""Joining two aligned motions over a window of frames."""

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.transition.window import Window


def smoothstep(weights: Array) -> Array:
    """The sigmoid variant of a linear weight: 3w² − 2w³."""
    return weights * weights * (3.0 - 2.0 * weights)


def interpolated_poses(
    rotations_a: Array, root_a: Array, rotations_b: Array, root_b: Array, weights: Array
) -> tuple[Array, Array]:
    """Rotations (N, J, 4) by slerp on the shorter arc and root (N, 3) by linear interpolation.

    `weights` (N,) of B for all joints, or (N, J) for each, the root's being the first.
    """
    each = weights if weights.ndim == 2 else weights[:, None]
    part = each[:, :1]
    return quat.slerp(rotations_a, rotations_b, each), (1.0 - part) * root_a + part * root_b


def spliced(a: Motion, b: Motion, first: int, after: int, rotations: Array, root: Array) -> Motion:
    """A before its frame `first`, the frames given, then B from its frame `after` to its end."""
    joined = np.concatenate([a.rotations[:first], rotations, b.rotations[after:]])
    path = np.concatenate([a.root[:first], root, b.root[after:]])
    return Motion(a.skeleton, joined, path, a.fps)


def blend_linear(a: Motion, b: Motion, window: Window, smooth: bool) -> Motion:
    """A[..], the window's frames mixed by its weights, B[..]; `b` is aligned already."""
    weights = smoothstep(window.weights) if smooth else window.weights
    return blend_weighted(a, b, window, weights)


def blend_weighted(a: Motion, b: Motion, window: Window, weights: Array) -> Motion:
    """The same with weights of B given, (N,) or for each joint (N, J)."""
    from_a = slice(window.first, window.last + 1)
    from_b = slice(window.first + window.lag, window.last + window.lag + 1)
    rotations, root = interpolated_poses(
        a.rotations[from_a], a.root[from_a], b.rotations[from_b], b.root[from_b], weights
    )
    return spliced(a, b, window.first, window.last + window.lag + 1, rotations, root)
