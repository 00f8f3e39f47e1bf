"""Writing BVH: metres turned to centimetres, Z Y X angles, as Blender and others read it."""

import re
from pathlib import Path

import numpy as np

from stimuli.files import write_atomic
from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion, Skeleton, children_of, depth_first_order

_PER_METRE = 100.0
_LEAST = 1e-7  # degrees, printed with seven decimals


def write_bvh(motion: Motion, path: Path) -> None:
    """Write a motion as BVH in centimetres: six channels for the root, three for each joint."""
    joints = depth_first_order(motion.skeleton.parents)
    text = ["HIERARCHY", *_hierarchy(motion.skeleton), "MOTION", f"Frames: {len(motion)}"]
    text.append(f"Frame Time: {1 / motion.fps:.9f}")
    write_atomic(path, "\n".join(text) + "\n" + _frames(motion, joints))


def _frames(motion: Motion, joints: list[int]) -> str:
    angles = np.degrees(quat.to_zyx(motion.rotations[:, joints]))
    # Readers take leading frames whose root does not turn at all for rest poses that an exporter
    # inserted, and drop them: a root at rest is written as turned by the least angle printed.
    at_rest = np.all(np.abs(angles[:, 0]) < _LEAST, axis=-1)
    angles[at_rest, 0, 0] = _LEAST
    values = np.concatenate([motion.root * _PER_METRE, angles.reshape(len(motion), -1)], axis=1)
    row = " ".join(["%.7f"] * values.shape[1])
    return "".join(row % tuple(frame) + "\n" for frame in values.tolist())


def _hierarchy(skeleton: Skeleton) -> list[str]:
    """The lines between HIERARCHY and MOTION."""
    children = children_of(skeleton.parents)
    lines: list[str] = []
    waiting: list[tuple[int, int]] = [(0, 0)]  # joint, depth; −1 − depth closes a brace
    while waiting:
        joint, depth = waiting.pop()
        indent = "\t" * depth
        if joint < 0:
            lines.append(f"{indent}}}")
            continue
        kind, turns = ("JOINT", "3") if joint else ("ROOT", "6 Xposition Yposition Zposition")
        lines += [
            f"{indent}{kind} {_fit(skeleton.names[joint])}",
            f"{indent}{{",
            f"{indent}\t{_offset(skeleton.offsets[joint])}",
            f"{indent}\tCHANNELS {turns} Zrotation Yrotation Xrotation",
        ]
        for end in np.flatnonzero(skeleton.end_parents == joint):
            offset = _offset(skeleton.end_offsets[end])
            lines += [f"{indent}\tEnd Site", f"{indent}\t{{"]
            lines += [f"{indent}\t\t{offset}", f"{indent}\t}}"]
        waiting.append((-1, depth))
        waiting += [(child, depth + 1) for child in reversed(children[joint])]
    return lines


def _offset(offset: Array) -> str:
    return "OFFSET " + " ".join(f"{value * _PER_METRE:.7f}" for value in offset)


def _fit(name: str) -> str:
    """A joint's name without what would break the format for strict readers."""
    return re.sub(r"[\s{}]+", "_", name)
