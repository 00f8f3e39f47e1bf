"""Which joint plays which anatomical part, told from names by families of exporters.

One name means different joints in different families (LeftShoulder is a clavicle in MotionBuilder
and the upper arm in 3ds Max), so all names of a skeleton are read in the family that explains
most of them. Trunk joints follow from the hierarchy: the pelvis is where the legs part, the chest
where the arms do, the spine the first joint above the pelvis that moves.
"""

import re
from collections.abc import Mapping, Sequence
from functools import lru_cache

import numpy as np

from stimuli.motion.quaternions import Array

LIMBS = ("clavicle", "shoulder", "elbow", "wrist", "hip", "knee", "ankle", "toe")
ROLES = (
    "pelvis", "spine", "chest", "neck", "head",
    *(f"{side}_{limb}" for side in ("left", "right") for limb in LIMBS),
)  # fmt: skip

_SIDED = (  # patterns of (side, core) on names without prefix, tried in turn
    re.compile(r"(?P<side>left|right)[_ .-]?(?P<core>.+)", re.IGNORECASE),
    re.compile(r"(?P<core>.+?)[_ .-]?(?P<side>left|right)", re.IGNORECASE),
    re.compile(r"(?P<side>[LR])[_ .-](?P<core>.+)", re.IGNORECASE),
    re.compile(r"(?P<core>.+)[_ .-](?P<side>[LR])", re.IGNORECASE),
    re.compile(r"(?P<side>[lrLR])(?P<core>[A-Z].*)"),
    re.compile(r"(?P<side>[lr])(?P<core>clavicle|humerus|radius|hand|femur|tibia|foot|toes)"),
)
_TRUNK = {
    "hips": "pelvis", "pelvis": "pelvis",
    "neck": "neck", "neck1": "neck", "neck01": "neck", "lowerneck": "neck",
    "head": "head", "face": "head", "head1": "head",
}  # fmt: skip
_SEGMENTS = {
    "shoulder": "clavicle", "clavicle": "clavicle", "collar": "clavicle",
    "upperarm": "shoulder", "uparm": "shoulder", "forearm": "elbow", "lowerarm": "elbow",
    "hand": "wrist", "thigh": "hip", "upperleg": "hip", "upleg": "hip", "shin": "knee",
    "calf": "knee", "lowerleg": "knee", "foot": "ankle", "toe": "toe", "toe0": "toe",
    "toebase": "toe", "ball": "toe",
}  # fmt: skip
FAMILIES: Mapping[str, Mapping[str, str]] = {
    # MotionBuilder, Mixamo, Rokoko, ACCAD, CMU in cgspeed's form
    "motionbuilder": _TRUNK | {
        "shoulder": "clavicle", "arm": "shoulder", "forearm": "elbow", "hand": "wrist",
        "upleg": "hip", "leg": "knee", "foot": "ankle", "toebase": "toe", "forefoot": "toe",
    },
    # Acclaim: bones named by anatomists
    "acclaim": _TRUNK | {
        "root": "pelvis", "clavicle": "clavicle", "humerus": "shoulder", "radius": "elbow",
        "hand": "wrist", "femur": "hip", "tibia": "knee", "foot": "ankle", "toes": "toe",
    },
    # DAZ and Poser: `hip` is the pelvis
    "daz": _TRUNK | {
        "hip": "pelvis", "collar": "clavicle", "shldr": "shoulder", "forearm": "elbow",
        "hand": "wrist", "thigh": "hip", "shin": "knee", "foot": "ankle", "toe": "toe",
    },
    # Blender, 3ds Max Biped, Xsens, Unreal: limbs named by their segments
    "segments": _TRUNK | _SEGMENTS,
    # Biovision, 3ds Max, SMPL, DeepMimic: limbs named by their joints
    "joints": _TRUNK | {
        "collar": "clavicle", "shoulder": "shoulder", "elbow": "elbow", "wrist": "wrist",
        "hip": "hip", "knee": "knee", "ankle": "ankle", "foot": "toe", "toe": "toe",
        "toebase": "toe",
    },
}  # fmt: skip


def resolve_roles(
    names: Sequence[str],
    parents: np.ndarray,
    rotations: Array,
    given: Mapping[str, str] | None = None,
) -> dict[str, int]:
    """Role → joint for a skeleton; `given` names joints for some roles and overrules the rest.

    `rotations` (F, J, 4) tell which joint of the trunk moves.
    """
    roles = max(
        (_read_in_family(names, family) for family in FAMILIES.values()),
        key=len,
    )
    index = {name: joint for joint, name in reversed(list(enumerate(names)))}
    roles |= {role: index[name] for role, name in (given or {}).items()}
    if "head" not in roles and "neck" in roles and roles["neck"] not in parents:
        roles["head"] = roles["neck"]  # nothing above the neck: its rotation moves the head
    trunk = _trunk(roles, parents, rotations)
    return roles | {role: joint for role, joint in trunk.items() if role not in (given or {})}


def missing_roles(roles: Mapping[str, int]) -> tuple[str, ...]:
    """The roles that no joint plays, in their usual order."""
    return tuple(role for role in ROLES if role not in roles)


def _read_in_family(names: Sequence[str], family: Mapping[str, str]) -> dict[str, int]:
    """Roles of the joints as one family would name them; the first of two claimants keeps it."""
    roles: dict[str, int] = {}
    for joint, name in enumerate(names):
        side, core = _side_and_core(name)
        part = family.get(core)
        if part is None or (part in LIMBS) != bool(side):
            continue
        roles.setdefault(f"{side}_{part}" if side else part, joint)
    return roles


@lru_cache(maxsize=4096)
def _side_and_core(name: str) -> tuple[str, str]:
    """("left", "upperarm") of "mixamorig:Left_UpperArm"; ("", core) for the trunk."""
    bare = re.sub(r"^(.*[:|]|mixamorig\d*_?|Bip\d+[_ ]|Character\d*_)", "", name)
    for pattern in _SIDED:
        if match := pattern.fullmatch(bare):
            side = "left" if match["side"].lower().startswith("l") else "right"
            return side, _plain(match["core"])
    return "", _plain(bare)


def _plain(core: str) -> str:
    return re.sub(r"[ _.-]", "", core).lower()


def _trunk(roles: Mapping[str, int], parents: np.ndarray, rotations: Array) -> dict[str, int]:
    """Pelvis, spine and chest as the hierarchy has them."""
    found: dict[str, int] = {}
    legs = _meeting(parents, roles, ("left_hip", "right_hip"))
    arms = _meeting(parents, roles, ("left_clavicle", "right_clavicle"))
    if arms is None:
        arms = _meeting(parents, roles, ("left_shoulder", "right_shoulder"))
    if legs is not None:
        found["pelvis"] = legs
    if arms is not None and arms != legs:
        found["chest"] = arms
    pelvis = found.get("pelvis", roles.get("pelvis"))
    above = _path(parents, found.get("chest", roles.get("neck", roles.get("head", -1))))
    if pelvis is not None and pelvis in above:
        trunk = above[above.index(pelvis) + 1 :]
        moving = [joint for joint in trunk if np.ptp(rotations[:, joint], axis=0).max() > 1e-6]
        if trunk:
            found["spine"] = (moving or trunk)[0]
    return found


def _meeting(parents: np.ndarray, roles: Mapping[str, int], pair: tuple[str, str]) -> int | None:
    """The nearest joint above both, or None where one of them is missing."""
    if not all(role in roles for role in pair):
        return None
    left, right = (_path(parents, roles[role])[:-1] for role in pair)
    common = [joint for joint in left if joint in right]
    return common[-1] if common else None


def _path(parents: np.ndarray, joint: int) -> list[int]:
    path: list[int] = []
    while joint >= 0:
        path.append(int(joint))
        joint = int(parents[joint])
    return path[::-1]
