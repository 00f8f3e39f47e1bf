"""Which joint plays which anatomical part, told from names by the conventions of their makers.

One name means different joints to different makers (LeftShoulder is a clavicle in MotionBuilder
and the upper arm in 3ds Max; LeftLeg is below LeftUpLeg, and a thigh nowhere), so the names of all
arms are read by the convention that explains most of them, and those of all legs by theirs. Trunk
joints follow from the hierarchy: the pelvis is where the legs part, the chest where the arms do,
the spine the first joint above the pelvis that moves.
"""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import lru_cache

import numpy as np

from stimuli.motion.quaternions import Array

LIMBS = ("clavicle", "shoulder", "elbow", "wrist", "hip", "knee", "ankle", "toe")
ROLES = (
    "pelvis", "spine", "chest", "neck", "head",
    *(f"{side}_{limb}" for side in ("left", "right") for limb in LIMBS),
)  # fmt: skip
Convention = Mapping[str, str]  # what a name says but for its side → part

TRUNK_NAMES: Convention = {
    **dict.fromkeys(
        ("hips", "pelvis", "hip", "root", "lowertorso", "下半身", "センター"), "pelvis"
    ),
    **dict.fromkeys(("neck", "lowerneck", "necklower", "necktwist", "cervical", "首"), "neck"),
    **dict.fromkeys(("head", "face", "skull", "頭"), "head"),
}
_CLAVICLE = dict.fromkeys(("clavicle", "collar", "collarbone", "scapula"), "clavicle")
ARMS_NAMES: Mapping[str, Convention] = {
    # MotionBuilder, Mixamo, Xsens, Unreal, Blender, Biped, OptiTrack, iClone, GENEA, Bandai-Namco
    "segments": _CLAVICLE | {
        "shoulder": "clavicle",
        "upperarm": "shoulder", "uparm": "shoulder", "uarm": "shoulder", "arm": "shoulder",
        "shldr": "shoulder", "shldrbend": "shoulder", "armstretch": "shoulder",
        "lowerarm": "elbow", "forearm": "elbow", "farm": "elbow", "larm": "elbow",
        "forearmbend": "elbow", "lowarm": "elbow", "forearmstretch": "elbow",
        "hand": "wrist", "wrist": "wrist",
    },
    # Biovision, 3ds Max, SMPL, DeepMimic, Kinect, Second Life, Advanced Skeleton
    "joints": _CLAVICLE | {
        "shoulder": "shoulder", "elbow": "elbow", "wrist": "wrist", "hand": "wrist",
    },
    # Acclaim: bones named by anatomists
    "bones": {
        "clavicle": "clavicle", "humerus": "shoulder", "radius": "elbow", "hand": "wrist",
    },
    "MikuMikuDance": {"肩": "clavicle", "腕": "shoulder", "ひじ": "elbow", "手首": "wrist"},
}  # fmt: skip
LEGS_NAMES: Mapping[str, Convention] = {
    "segments": {
        "upleg": "hip", "upperleg": "hip", "thigh": "hip", "uleg": "hip", "thighbend": "hip",
        "thighstretch": "hip", "legstretch": "knee",
        "leg": "knee", "lowerleg": "knee", "shin": "knee", "calf": "knee", "shank": "knee",
        "lleg": "knee", "lowleg": "knee", "knee": "knee", "foot": "ankle", "ankle": "ankle",
        "toe": "toe", "toes": "toe", "toebase": "toe", "ball": "toe", "forefoot": "toe",
        "toe11": "toe",
    },
    "joints": {
        "hip": "hip", "knee": "knee", "ankle": "ankle",
        "foot": "toe", "toe": "toe", "toes": "toe", "toebase": "toe", "ball": "toe",
    },
    "joints down to the foot": {
        "hip": "hip", "knee": "knee", "foot": "ankle", "toe": "toe", "toes": "toe",
        "toebase": "toe", "ball": "toe",
    },
    "bones": {"femur": "hip", "tibia": "knee", "foot": "ankle", "toes": "toe"},
    "MikuMikuDance": {"足": "hip", "ひざ": "knee", "足首": "ankle", "つま先": "toe"},
}  # fmt: skip

_SIDED = (  # patterns of (side, core) on names without what they all share, tried in turn
    re.compile(r"(?P<side>left|right)[_ .-]?(?P<core>.+)", re.IGNORECASE),
    re.compile(r"(?P<core>.+?)[_ .-]?(?P<side>left|right)", re.IGNORECASE),
    re.compile(r"(?P<side>[左右])(?P<core>.+)"),
    re.compile(r"(?P<side>[LR])[_ .-](?P<core>.+)", re.IGNORECASE),
    re.compile(r"(?P<core>.+)[_ .-](?P<side>[LR])", re.IGNORECASE),
    re.compile(r"(?P<side>[lrLR])(?P<core>[A-Z].*)"),
    re.compile(r"(?P<core>.*[a-z0-9])(?P<side>[LR])"),
    re.compile(
        r"(?P<side>[lr])(?P<core>clavicle|collar|shoulder|humerus|radius|elbow|wrist|hand|uparm|"
        r"upperarm|forearm|lowerarm|lowarm|arm|hip|femur|thigh|knee|tibia|shin|shank|calf|upleg|"
        r"upperleg|lowerleg|lowleg|leg|ankle|foot|toes?)",
        re.IGNORECASE,
    ),
)
_LEFT = ("l", "L", "左")
_MIDDLE = re.compile(r"^(C|M|Center|Mid)[_ .-]|[_ .-](C|M|x)$")
_OF_MAKERS = re.compile(r"^(.*[:|]|mixamorig\d*_?|Bip\d+[_ ]|Character\d*_)")
_PARTED = re.compile(r"[_ .-]")
_SHARED = 0.8  # of all names: what so many begin or end with says nothing
_FEW = 8  # names, of which many may begin alike by chance
_MOST_PARTS = 4  # that all names share at one end
_SIDES = {"l", "r", "left", "right"}


def resolve_roles(
    names: Sequence[str],
    parents: np.ndarray,
    rotations: Array,
    given: Mapping[str, str] | None = None,
) -> dict[str, int]:
    """Role → joint for a skeleton; `given` names joints for some roles and overrules the rest.

    `rotations` (F, J, 4) tell which joint of the trunk moves.
    """
    read = [_side_and_core(name) for name in bare_names(names)]
    roles = _read(read, TRUNK_NAMES, sided=False)
    for conventions in (ARMS_NAMES, LEGS_NAMES):
        limbs = [_read(read, convention, sided=True) for convention in conventions.values()]
        fullest: dict[str, int] = max(limbs, key=len)
        roles |= fullest
    index = {name: joint for joint, name in reversed(list(enumerate(names)))}
    roles |= {role: index[name] for role, name in (given or {}).items()}
    if "head" not in roles and "neck" in roles and roles["neck"] not in parents:
        roles["head"] = roles["neck"]  # nothing above the neck: its rotation moves the head
    trunk = trunk_roles(roles, parents, rotations)
    return roles | {role: joint for role, joint in trunk.items() if role not in (given or {})}


def missing_roles(roles: Mapping[str, int]) -> tuple[str, ...]:
    """The roles that no joint plays, in their usual order."""
    return tuple(role for role in ROLES if role not in roles)


def bare_names(names: Sequence[str]) -> list[str]:
    """Names without what most of them share at either end: a maker's, a character's, a suffix."""
    bare = [_OF_MAKERS.sub("", name) or name for name in names]
    if len(bare) < _FEW:
        return bare
    for pattern in (r"^([^_ .-]+[_ .-])", r"^([a-z])(?=[A-Z])", r"([_ .-][^_ .-]+)$"):
        for _ in range(_MOST_PARTS):
            if (shared := _shared(bare, re.compile(pattern))) is None:
                break
            cut = re.compile(rf"^{re.escape(shared)}|{re.escape(shared)}$")
            bare = [cut.sub("", name, count=1) or name for name in bare]
    return bare


def _shared(names: Sequence[str], pattern: re.Pattern[str]) -> str | None:
    """What most names have where the pattern looks, unless it is a side."""
    found = Counter(match[1] for name in names if (match := pattern.search(name)))
    for part, count in found.most_common(1):
        if count >= _SHARED * len(names) and _PARTED.sub("", part).lower() not in _SIDES:
            return part
    return None


def _read(
    names: Sequence[tuple[str, str]], convention: Convention, *, sided: bool
) -> dict[str, int]:
    """Roles of joints (side, core) as a convention has them; the first of two claimants keeps it.

    A digit behind a name, as in toe0, neck1 and upperleg01, counts the first of several.
    """
    roles: dict[str, int] = {}
    for joint, (side, core) in enumerate(names):
        part = convention.get(core) or convention.get(re.sub(r"0*[01]?$", "", core))
        if part is not None and sided == bool(side):
            roles.setdefault(f"{side}_{part}" if side else part, joint)
    return roles


@lru_cache(maxsize=4096)
def _side_and_core(name: str) -> tuple[str, str]:
    """("left", "upperarm") of "Left_UpperArm"; ("", core) for the trunk."""
    for pattern in _SIDED:
        if match := pattern.fullmatch(name):
            side = "left" if match["side"].startswith(_LEFT) else "right"
            return side, _plain(match["core"])
    return "", _plain(_MIDDLE.sub("", name))


def _plain(core: str) -> str:
    return _PARTED.sub("", core).lower()


def trunk_roles(roles: Mapping[str, int], parents: np.ndarray, rotations: Array) -> dict[str, int]:
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
    above = chain_to(parents, found.get("chest", roles.get("neck", roles.get("head", -1))))
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
    left, right = (chain_to(parents, roles[role])[:-1] for role in pair)
    common = [joint for joint in left if joint in right]
    return common[-1] if common else None


def chain_to(parents: np.ndarray, joint: int) -> list[int]:
    """Joints from the root to a joint, both included; none for −1."""
    path: list[int] = []
    while joint >= 0:
        path.append(int(joint))
        joint = int(parents[joint])
    return path[::-1]
