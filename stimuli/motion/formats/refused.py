"""Formats that are known and not read, with what to convert them with."""

from collections.abc import Mapping
from pathlib import Path

from stimuli.errors import InputError
from stimuli.motion.formats.source import Take, fault

_SCENE = "Import it into Blender (or MotionBuilder) and export the armature's motion as BVH."
_SOLVE = "Solve it onto a skeleton (MotionBuilder, Vicon, Motive or Blender) and export BVH."
_MODEL = (
    "Take the motion as an AMASS archive (.npz), or export BVH with the SMPL add-on of Blender."
)
REFUSED: Mapping[str, tuple[str, str]] = {
    ".fbx": ("FBX, a scene", _SCENE),
    ".glb": ("glTF, a scene", _SCENE),
    ".gltf": ("glTF, a scene", _SCENE),
    ".vrm": ("VRM, a character", _SCENE),
    ".dae": ("COLLADA, a scene", _SCENE),
    ".usd": ("USD, a scene", _SCENE),
    ".usda": ("USD, a scene", _SCENE),
    ".usdc": ("USD, a scene", _SCENE),
    ".usdz": ("USD, a scene", _SCENE),
    ".abc": ("Alembic, a scene", _SCENE),
    ".blend": ("a file of Blender", "Open it in Blender and export the armature's motion as BVH."),
    ".bip": ("a file of 3ds Max Biped", "Load it in 3ds Max and export the biped as BVH."),
    ".mvnx": ("MVNX of Xsens", "Export BVH from Xsens MVN."),
    ".vmd": ("a motion of MikuMikuDance", _SCENE),
    ".trc": ("TRC, which holds positions of markers and no skeleton", _SOLVE),
    ".trb": ("TRB, which holds positions of markers and no skeleton", _SOLVE),
    ".csv": ("CSV, a table of markers or of rigid bodies", _SOLVE),
    ".tsv": ("TSV, a table of markers or of rigid bodies", _SOLVE),
    ".c3d": ("C3D, which holds positions of markers and no skeleton", _SOLVE),
    ".mot": ("MOT, joint angles of a model of OpenSim", _SOLVE),
    ".pkl": ("a pickle, which can run any program", _MODEL),
    ".npy": ("a NumPy array without names", _MODEL),
    ".pt": ("a file of PyTorch, which can run any program", _MODEL),
    ".pth": ("a file of PyTorch, which can run any program", _MODEL),
}


def refusal(path: Path) -> InputError:
    """Why a file is not read, and what to do; its suffix is one of REFUSED."""
    found, todo = REFUSED[path.suffix.lower()]
    return fault(path, "joint rotations of a skeleton", found, todo)


def refuse(path: Path, data: bytes, fps: float | None = None) -> Take:
    """A reader that refuses."""
    raise refusal(path)
