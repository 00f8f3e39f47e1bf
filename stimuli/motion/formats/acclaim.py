"""Reading Acclaim motion: a skeleton (ASF) and its poses (AMC).

A bone turns by C M C⁻¹, where C is its `axis` and M its degrees of freedom, both about the axes in
the order named, each about the fixed ones: "XYZ" is Rz Ry Rx. Joints of the result are the bones'
upper ends, named as the bones, so that in rest all rotations are the identity.
"""

from pathlib import Path

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.formats.acclaim_poses import read_poses
from stimuli.motion.formats.acclaim_skeleton import Bone, read_asf
from stimuli.motion.formats.rates import rounded_rate
from stimuli.motion.formats.source import (
    Take,
    check_size,
    contents,
    fault,
    text_of,
)
from stimuli.motion.quaternions import Array

DEFAULT_RATE = 120.0


def read_acclaim(path: Path, data: bytes, fps: float | None = None) -> Take:
    """The motion of an AMC file with the ASF beside it; 120 frames a second unless `fps` is given.

    The skeleton is the ASF of the same stem, else of the part before the first underscore, else
    the only one in the directory.
    """
    text = text_of(path, data)
    asf = _skeleton_beside(path)
    skeleton = read_asf(asf, text_of(asf, contents(asf)))
    poses = read_poses(path, text, skeleton)
    frames, frame_rate = len(next(iter(poses.values.values()))), fps or DEFAULT_RATE
    check_size(path, frames, len(skeleton.bones), frame_rate)
    unit = np.pi / 180 if poses.degrees else 1.0
    rotations = np.tile(quat.IDENTITY, (frames, len(skeleton.bones), 1))
    root = np.tile(skeleton.position, (frames, 1))
    notes = [] if fps is not None else ["AMC files carry no rate: 120 frames a second taken"]
    for joint, bone in enumerate(skeleton.bones):
        if bone.name in poses.values:
            turns, moves = _by_axis(bone, poses.values[bone.name])
            rotations[:, joint] = _turned(bone, turns * unit)
            if joint == 0:
                root = root + moves
            elif np.ptp(moves, axis=0).max() > 0:
                notes.append(f"translations of {bone.name} are left out")
    if silent := [b.name for b in skeleton.bones if b.freedoms and b.name not in poses.values]:
        notes.append(f"no values for {', '.join(silent)}: taken at rest")
    return Take(
        format="amc",
        names=tuple(bone.name for bone in skeleton.bones),
        parents=np.array(skeleton.parents),
        offsets=skeleton.offsets,
        end_parents=np.array(skeleton.leaves, dtype=int),
        end_offsets=np.array([skeleton.bones[leaf].vector for leaf in skeleton.leaves]),
        rotations=rotations,
        root=root,
        fps=rounded_rate(frame_rate),
        warnings=tuple(notes),
    )


def refuse_asf(path: Path, data: bytes, fps: float | None = None) -> Take:
    """An ASF holds no motion."""
    raise fault(path, "a motion", "an Acclaim skeleton", "Name the .amc file; this one lies by it.")


def _skeleton_beside(path: Path) -> Path:
    """The ASF that belongs to an AMC."""
    beside = sorted(p for p in path.parent.glob("*") if p.suffix.lower() == ".asf")
    by_stem = {p.stem: p for p in beside}
    for stem in (path.stem, path.stem.split("_")[0]):
        if stem in by_stem:
            return by_stem[stem]
    if len(beside) == 1:
        return beside[0]
    found = f"{len(beside)} others" if beside else "none"
    raise fault(
        path,
        f"its skeleton {path.stem}.asf or {path.stem.split('_')[0]}.asf beside it",
        found,
        "Put the ASF of this performer into the same directory.",
    )


def _by_axis(bone: Bone, values: Array) -> tuple[Array, Array]:
    """Rotations (F, 3) about and translations (F, 3) along X, Y, Z; 0 where there is no freedom."""
    turns, moves = np.zeros((len(values), 3)), np.zeros((len(values), 3))
    for column, freedom in enumerate(bone.freedoms):
        kind, axis = freedom[0], "xyz".find(freedom[-1])
        if kind in "rt" and axis >= 0:
            (turns if kind == "r" else moves)[:, axis] = values[:, column]
    return turns, moves


def _turned(bone: Bone, turns: Array) -> Array:
    """C M C⁻¹ (F, 4) of rotations (F, 3) about X, Y, Z in radians."""
    order = bone.order[::-1]  # about fixed axes in turn is intrinsic in the reverse order
    places = ["XYZ".index(axis) for axis in order]
    moved = quat.from_euler(turns[:, places], order)
    return quat.multiply(quat.multiply(bone.axis, moved), quat.inverse(bone.axis))
