"""Reading AMASS (Mahmood et al. 2019): NumPy archives of the poses of a SMPL-H body.

`poses` (F, 156) are rotation vectors of 52 joints, `trans` (F, 3) is where the pelvis goes, in
metres with +Z up; `mocap_framerate` is the rate. Poses of SMPL-X (165 numbers) and of SMPL (72) are
taken for what they share with these. The files hold no bones: a person's follow from a model that
is under a licence of its own. The bones here are those of a standard body, 1.70 m tall, by the
segment lengths of Drillis and Contini (in Winter 2009) in the rest pose of SMPL: it faces +Z with
its arms out to the sides.
"""

import zipfile
import zlib
from io import BytesIO
from pathlib import Path

import numpy as np

from stimuli.errors import InputError
from stimuli.motion import quaternions as quat
from stimuli.motion.formats.rates import is_rate, rounded_rate
from stimuli.motion.formats.source import Take, check_size, depth_first, fault
from stimuli.motion.formats.words import IN_BOUNDS, LARGEST_NUMBER
from stimuli.motion.quaternions import Array

_STATURE = 1.70
_BODY = (  # name, parent, offset as a part of the stature; of sides, the left one
    ("pelvis", "", (0, 0, 0)),
    ("left_hip", "pelvis", (0.05, -0.05, 0)), ("right_hip", "pelvis", (0.05, -0.05, 0)),
    ("spine1", "pelvis", (0, 0.06, 0)),
    ("left_knee", "left_hip", (0, -0.245, 0)), ("right_knee", "right_hip", (0, -0.245, 0)),
    ("spine2", "spine1", (0, 0.08, 0)),
    ("left_ankle", "left_knee", (0, -0.246, 0)), ("right_ankle", "right_knee", (0, -0.246, 0)),
    ("spine3", "spine2", (0, 0.03, 0)),
    ("left_foot", "left_ankle", (0, -0.03, 0.07)), ("right_foot", "right_ankle", (0, -0.03, 0.07)),
    ("neck", "spine3", (0, 0.11, 0)),
    ("left_collar", "spine3", (0.045, 0.06, 0)), ("right_collar", "spine3", (0.045, 0.06, 0)),
    ("head", "neck", (0, 0.04, 0)),
    ("left_shoulder", "left_collar", (0.0845, 0.008, 0)),
    ("right_shoulder", "right_collar", (0.0845, 0.008, 0)),
    ("left_elbow", "left_shoulder", (0.186, 0, 0)),
    ("right_elbow", "right_shoulder", (0.186, 0, 0)),
    ("left_wrist", "left_elbow", (0.146, 0, 0)), ("right_wrist", "right_elbow", (0.146, 0, 0)),
)  # fmt: skip
_FINGERS = (  # name, its first joint from the wrist, and the bones from there, tip included
    ("index", (0.055, 0, 0.014), (0.02, 0.013, 0.012)),
    ("middle", (0.056, 0, 0.003), (0.022, 0.015, 0.014)),
    ("pinky", (0.048, 0, -0.018), (0.015, 0.01, 0.01)),
    ("ring", (0.053, 0, -0.008), (0.02, 0.014, 0.013)),
    ("thumb", (0.015, -0.005, 0.018), (0.02, 0.018, 0.015)),
)
_ENDS = {
    "head": (0, 0.1, 0), "left_foot": (0, -0.009, 0.045), "right_foot": (0, -0.009, 0.045),
}  # fmt: skip
_HANDS = {  # numbers a frame: the first of a hand's joints, and what is not taken
    156: (22, ""),
    165: (25, "the face of SMPL-X"),
    72: (None, "the hands of SMPL, each of one joint"),
}
_MOST_BYTES = 300_000_000  # of poses, which hold as many rotations as any motion may
_BROKEN = (zipfile.BadZipFile, zlib.error, EOFError, OSError, ValueError, RuntimeError)
_TODO = "Take the archive from its source again; Segue reads AMASS as it is published."


def read_amass(path: Path, data: bytes, fps: float | None = None) -> Take:
    """The motion of an AMASS archive; `fps` overrides its rate."""
    arrays = _arrays(path, data)
    poses, trans = arrays["poses"], arrays["trans"]
    frames = len(poses) if poses.ndim == 2 else 0
    if not frames or poses.shape[1] not in _HANDS or trans.shape != (frames, 3):
        found = f"poses {poses.shape} and trans {trans.shape}"
        raise fault(path, "poses (F, 156) and trans (F, 3)", found, _TODO)
    rate = _rate(path, arrays.get("rate"), fps)
    names, parents, offsets, end_parents, end_offsets = _skeleton()
    check_size(path, frames, len(names), rate)
    vectors, left_out = _of_smplh(poses.astype(float))
    for name, values in (("poses", vectors), ("trans", trans)):
        if not np.all(np.abs(values) < LARGEST_NUMBER):
            frame = int(np.argwhere(~(np.abs(values) < LARGEST_NUMBER))[0, 0])
            found = f"another in {name}, frame {frame + 1}"
            raise fault(path, f"numbers {IN_BOUNDS}", found, _TODO)
    notes = [f"the bones are those of a standard body of {_STATURE:.2f} m, not of this person"]
    if left_out:
        notes.append(f"{left_out}: left out")
    take = Take(
        format="amass",
        names=names,
        parents=parents,
        offsets=offsets,
        end_parents=end_parents,
        end_offsets=end_offsets,
        rotations=quat.exp(0.5 * vectors),
        root=trans.astype(float),
        fps=rate,
        world="Z",
        warnings=tuple(notes),
    )
    return depth_first(take)


def is_amass(path: Path) -> bool:
    """Whether an archive holds poses."""
    try:
        with zipfile.ZipFile(path) as archive:
            return {"poses.npy", "trans.npy"} <= set(archive.namelist())
    except (OSError, zipfile.BadZipFile):
        return False


def _arrays(path: Path, data: bytes) -> dict[str, np.ndarray]:
    """The arrays `poses` and `trans`, and the `rate` where there is one."""
    try:
        with zipfile.ZipFile(BytesIO(data)) as archive:
            there = {name.removesuffix(".npy"): name for name in archive.namelist()}
            if missing := [name for name in ("poses", "trans") if name not in there]:
                found = f"{', '.join(list(there)[:8]) or 'nothing'}: no {' and no '.join(missing)}"
                raise fault(path, "the arrays poses and trans of AMASS", found, _TODO)
            wanted = {"poses": "poses", "trans": "trans", "mocap_framerate": "rate",
                      "mocap_frame_rate": "rate"}  # fmt: skip
            return {
                kind: _array(path, archive, there[name])
                for name, kind in wanted.items()
                if name in there
            }
    except InputError:
        raise
    except _BROKEN as error:
        raise fault(path, "a NumPy archive", str(error) or "a broken one", _TODO) from None


def _array(path: Path, archive: zipfile.ZipFile, name: str) -> np.ndarray:
    """One array of numbers, which is not unpacked before its header says how large it is."""
    with archive.open(name) as stream:
        try:
            version = np.lib.format.read_magic(stream)
            header = {(1, 0): np.lib.format.read_array_header_1_0,
                      (2, 0): np.lib.format.read_array_header_2_0}[version]  # fmt: skip
            shape, by_columns, kind = header(stream)
        except (ValueError, KeyError, SyntaxError) as error:
            raise fault(path, f"an array {name}", f"another thing ({error})", _TODO) from None
        if kind.kind not in "fiu" or kind.itemsize > 8:
            raise fault(path, f"numbers in {name}", f"{kind}", _TODO)
        size = int(np.prod(shape, dtype=object)) * kind.itemsize
        if size > _MOST_BYTES:
            raise fault(path, f"at most {_MOST_BYTES:,} bytes of {name}", f"{size:,}", _TODO)
        held = archive.getinfo(name).file_size
        content = stream.read(size) if size <= held else b""
    if len(content) != size:
        raise fault(path, f"{size:,} bytes in {name}", f"{held:,}", _TODO)
    array = np.frombuffer(content, dtype=kind)
    return array.reshape(shape, order="F" if by_columns else "C")


def _rate(path: Path, written: np.ndarray | None, fps: float | None) -> float:
    """Frames a second, as given or as written."""
    if fps is not None:
        return fps
    if written is None or written.size != 1:
        todo = "Give its rate: fps in an overrides file."
        raise fault(path, "mocap_framerate, one number", "none", todo)
    rate = float(written.reshape(()))
    if not is_rate(rate):
        raise fault(path, "a mocap_framerate of 1 to 2000", f"{rate:g}", _TODO)
    return rounded_rate(rate)


def _of_smplh(poses: Array) -> tuple[Array, str]:
    """Rotation vectors (F, 52, 3) of SMPL-H, and what of the poses is none of them."""
    first, left_out = _HANDS[poses.shape[1]]
    vectors = poses.reshape(len(poses), -1, 3)
    hands = vectors[:, first : first + 30] if first else np.zeros((len(poses), 30, 3))
    return np.concatenate([vectors[:, :22], hands], axis=1), left_out


def _skeleton() -> tuple[tuple[str, ...], np.ndarray, Array, np.ndarray, Array]:
    """Names, parents, offsets, and parents and offsets of end sites, in the order of SMPL-H."""
    joints: list[tuple[str, str, tuple[float, ...]]] = list(_BODY)
    ends: dict[str, tuple[float, ...]] = dict(_ENDS)
    for side in ("left", "right"):
        for finger, start, bones in _FINGERS:
            above, offset = f"{side}_wrist", tuple(start)
            for number, bone in enumerate(bones, start=1):
                joints.append((f"{side}_{finger}{number}", above, offset))
                above, offset = f"{side}_{finger}{number}", (bone, 0, 0)
            ends[above] = offset
    names = [name for name, *_ in joints]
    mirror = np.array([[-1.0 if name.startswith("right") else 1.0, 1, 1] for name in names])
    offsets = _STATURE * mirror * np.array([offset for *_, offset in joints], dtype=float)
    places = [names.index(name) for name in ends]
    tips = _STATURE * mirror[places] * np.array(list(ends.values()), dtype=float)
    parents = np.array([names.index(above) if above else -1 for _, above, _ in joints])
    return tuple(names), parents, offsets, np.array(places), tips
