"""Reading Acclaim motion: a skeleton (ASF) and its poses (AMC).

A bone turns by C M C⁻¹, where C is its `axis` and M its degrees of freedom, both about the axes in
the order named, each about the fixed ones: "XYZ" is Rz Ry Rx. Joints of the result are the bones'
upper ends, named as the bones, so that in rest all rotations are the identity.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.formats.acclaim_skeleton import REMEDY, AcclaimSkeleton, Bone, read_asf
from stimuli.motion.formats.source import (
    LARGEST_NUMBER,
    Source,
    decode,
    fault,
    rounded_rate,
    shown,
)
from stimuli.motion.quaternions import Array

DEFAULT_RATE = 120.0


@dataclass
class _Table:
    """The poses of an AMC: values (F, width) of each bone it names, and the unit of angles."""

    values: dict[str, Array]
    degrees: bool


def read_acclaim(path: Path, data: bytes, fps: float | None = None) -> Source:
    """The motion of an AMC file with the ASF beside it; 120 frames a second unless `fps` is given.

    The skeleton is the ASF of the same stem, else of the part before the first underscore, else
    the only one in the directory.
    """
    text = decode(path, data)
    asf = _skeleton_beside(path)
    skeleton = read_asf(asf, decode(asf, asf.read_bytes()))
    table = _read_amc(path, text, skeleton)
    frames = len(next(iter(table.values.values())))
    unit = np.pi / 180 if table.degrees else 1.0
    rotations = np.tile(quat.IDENTITY, (frames, len(skeleton.bones), 1))
    root = np.tile(skeleton.position, (frames, 1))
    notes = [] if fps is not None else ["AMC files carry no rate: 120 frames a second taken"]
    for joint, bone in enumerate(skeleton.bones):
        if bone.name in table.values:
            turns, moves = _by_axis(bone, table.values[bone.name])
            rotations[:, joint] = _turned(bone, turns * unit)
            if joint == 0:
                root = root + moves
            elif np.ptp(moves, axis=0).max() > 0:
                notes.append(f"translations of {bone.name} are left out")
    if silent := [b.name for b in skeleton.bones if b.freedoms and b.name not in table.values]:
        notes.append(f"no values for {', '.join(silent)}: taken at rest")
    return Source(
        format="amc",
        names=tuple(bone.name for bone in skeleton.bones),
        parents=np.array(skeleton.parents),
        offsets=skeleton.offsets,
        end_parents=np.array(skeleton.leaves, dtype=int),
        end_offsets=np.array([skeleton.bones[leaf].vector for leaf in skeleton.leaves]),
        rotations=rotations,
        root=root,
        fps=rounded_rate(fps if fps is not None else DEFAULT_RATE),
        warnings=tuple(notes),
    )


def refuse_asf(path: Path, data: bytes, fps: float | None = None) -> Source:
    """An ASF holds no motion."""
    raise fault(path, "a motion", "an Acclaim skeleton", "Name the .amc file; this one lies by it.")


def refuse_c3d(path: Path, data: bytes, fps: float | None = None) -> Source:
    """A C3D holds markers, from which a skeleton must be solved first."""
    raise fault(
        path,
        "joint rotations of a skeleton",
        "C3D, which holds positions of markers and no skeleton",
        "Solve it onto a skeleton (MotionBuilder, Vicon, Motive or Blender) and export BVH.",
    )


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


def _read_amc(path: Path, text: str, skeleton: AcclaimSkeleton) -> _Table:
    """All poses; every frame must name the same bones, frames must count on by one."""
    widths = {bone.name: len(bone.freedoms) for bone in skeleton.bones}
    degrees = skeleton.degrees
    rows: dict[str, list[list[float]]] = {}
    frame, first = None, 0
    for number, raw in enumerate(text.split("\n"), start=1):
        words = raw.split()
        if not words or words[0].startswith("#"):
            continue
        if words[0].startswith(":"):
            unit = words[0].upper()
            degrees = {":DEGREES": True, ":RADIANS": False}.get(unit, degrees)
        elif len(words) == 1 and words[0].isdigit():
            if frame is None:
                first = frame = int(words[0])
            else:
                _check_frame(path, rows, frame - first + 1, number)
                frame += 1
            if int(words[0]) != frame:
                raise fault(path, f"frame {frame}", f"frame {shown(words[0])}", REMEDY, number)
        elif frame is None:
            raise fault(path, "a frame number", shown(raw), REMEDY, number)
        else:
            _add_row(path, rows, widths, words, number)
    if frame is None:
        raise fault(path, "frames", "none", REMEDY)
    _check_frame(path, rows, frame - first + 1, None)
    return _Table({name: np.array(values) for name, values in rows.items()}, degrees)


def _add_row(
    path: Path,
    rows: dict[str, list[list[float]]],
    widths: dict[str, int],
    words: list[str],
    line: int,
) -> None:
    """The values of one bone in one frame."""
    name = words[0]
    if name not in widths:
        raise fault(path, "a bone of the ASF", shown(name), "Use the ASF of this performer.", line)
    try:
        values = [float(word) for word in words[1:]]
    except ValueError:
        raise fault(path, "numbers", shown(" ".join(words)), REMEDY, line) from None
    if len(values) != widths[name] or not all(abs(v) < LARGEST_NUMBER for v in values):
        raise fault(
            path, f"{widths[name]} numbers for {name}", shown(" ".join(words), 60), REMEDY, line
        )
    rows.setdefault(name, []).append(values)


def _check_frame(
    path: Path, rows: dict[str, list[list[float]]], frames: int, line: int | None
) -> None:
    """InputError unless every bone has as many rows as there are frames."""
    if not rows or any(len(values) != frames for values in rows.values()):
        odd = next((name for name, values in rows.items() if len(values) != frames), "all bones")
        raise fault(path, "every bone once in each frame", f"{odd} missing or twice", REMEDY, line)


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
