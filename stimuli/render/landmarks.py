"""Where a body's parts begin and end, read off a skeleton in the reference pose.

Skeletons differ in what they have: no toes, no head, one joint for the whole trunk. What is
missing is put where the proportions of a body place it (stature = leg length / 0.491), and is
carried by the nearest joint that exists.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stimuli.motion.quaternions import Array
from stimuli.render.reference import TOES, Reference

LEG_TO_STATURE = 0.491
MIRRORED = (("left", 1.0), ("right", -1.0))
INSTEAD = {
    "head": ("neck", "chest", "spine", "pelvis"),
    "neck": ("chest", "spine", "pelvis"),
    "chest": ("spine", "pelvis"),
    "clavicle": ("chest", "spine", "pelvis"),
    "wrist": ("elbow",),
    "toe": ("ankle",),
}


@dataclass(frozen=True, eq=False)
class Landmarks:
    """Points (3,) in metres of a body in the reference pose, and the joints that carry its bones.

    `joints` has every role, each with the joint that plays it or the nearest one that stands in;
    `trunk` the joints from the pelvis up to below the neck.
    """

    points: Mapping[str, Array]
    joints: Mapping[str, int]
    trunk: tuple[int, ...]
    stature: float
    sole: float  # height of the soles


def landmarks(reference: Reference) -> Landmarks:
    """Find the landmarks; InputError where hips, knees, ankles, shoulders or elbows are missing."""
    skeleton, at = reference.skeleton, reference.positions
    skeleton.role(*(f"{side}_{part}" for side, _ in MIRRORED for part in REQUIRED), "pelvis")
    joints = _joints(dict(skeleton.roles))
    points = {role: at[joint] for role, joint in joints.items()}
    leg = np.mean(
        [
            np.linalg.norm(points[f"{s}_hip"] - points[f"{s}_knee"])
            + np.linalg.norm(points[f"{s}_knee"] - points[f"{s}_ankle"])
            for s, _ in MIRRORED
        ]
    )
    stature = float(leg) / LEG_TO_STATURE
    points |= _wrists(points, skeleton.roles, stature)
    sole = _sole(points, skeleton.roles, stature)
    points |= _feet(points, skeleton.roles, stature)
    points |= _trunk_points(points, stature)
    points |= _head(points, skeleton.roles, stature, sole)
    chain = skeleton.chain(joints["neck"])
    start = chain.index(joints["pelvis"]) if joints["pelvis"] in chain else 0
    stop = len(chain) - 1 if "neck" in skeleton.roles else len(chain)
    trunk = tuple(chain[start:stop])
    points |= {f"trunk{k}": at[joint] for k, joint in enumerate(trunk)}
    return Landmarks(points, joints, trunk, stature, sole)


REQUIRED = ("hip", "knee", "ankle", "shoulder", "elbow")


def _joints(roles: Mapping[str, int]) -> dict[str, int]:
    """Every role, with a stand-in for those that no joint plays."""
    joints = dict(roles)
    for role in ("spine", "chest", "neck", "head"):
        stand_ins = INSTEAD.get(role, ("pelvis",))
        joints.setdefault(role, next(joints[r] for r in stand_ins if r in joints))
    for side, _ in MIRRORED:
        for part in ("clavicle", "wrist", "toe"):
            names = (r if r in joints else f"{side}_{r}" for r in INSTEAD[part])
            joints.setdefault(f"{side}_{part}", next(joints[r] for r in names if r in joints))
    return joints


def _wrists(points: Mapping[str, Array], roles: Mapping[str, int], stature: float) -> dict:
    """Wrists, and fingertips: longer where the forearm is short, as if the fist were open."""
    found = {}
    for side, _ in MIRRORED:
        elbow, shoulder = points[f"{side}_elbow"], points[f"{side}_shoulder"]
        arm = (elbow - shoulder) / np.linalg.norm(elbow - shoulder)
        wrist = points[f"{side}_wrist"]
        if f"{side}_wrist" not in roles or np.linalg.norm(wrist - elbow) < 0.05 * stature:
            wrist = elbow + 0.146 * stature * arm
        forearm = float(np.linalg.norm(wrist - elbow))
        hand = np.clip(0.254 * stature - forearm, 0.072 * stature, 0.105 * stature)
        found[f"{side}_wrist"] = wrist
        found[f"{side}_fingertip"] = wrist + hand * (wrist - elbow) / forearm
    return found


def _sole(points: Mapping[str, Array], roles: Mapping[str, int], stature: float) -> float:
    """Height of the soles, from the toe joints where there are any, else below the ankles."""
    ankle = min(points[f"{side}_ankle"][1] for side, _ in MIRRORED)
    toes = [points[f"{side}_toe"][1] for side, _ in MIRRORED if f"{side}_toe" in roles]
    wanted = min(toes) - 0.013 * stature if toes else ankle - 0.043 * stature
    return float(np.clip(wanted, ankle - 0.052 * stature, ankle - 0.034 * stature))


def _feet(points: Mapping[str, Array], roles: Mapping[str, int], stature: float) -> dict:
    """Where each foot points, as its ball: a tenth of the leg's length ahead of the ankle."""
    found = {}
    for side, sign in MIRRORED:
        ahead = np.array([sign * np.sin(TOES), 0.0, np.cos(TOES)])
        if f"{side}_toe" in roles:
            level = (points[f"{side}_toe"] - points[f"{side}_ankle"]) * [1, 0, 1]
            length = float(np.linalg.norm(level))
            ahead = level / length if length > 0.01 * stature else ahead
        found[f"{side}_ahead"] = ahead
        found[f"{side}_ball"] = points[f"{side}_ankle"] + 0.072 * stature * ahead
    return found


def _trunk_points(points: Mapping[str, Array], stature: float) -> dict:
    """Middle of the hips and top of the trunk (between the shoulders, not far below the neck)."""
    hips = (points["left_hip"] + points["right_hip"]) / 2
    shoulders = (points["left_shoulder"] + points["right_shoulder"]) / 2
    neck = points["neck"] * [0.0, 1.0, 1.0]
    if neck[1] < shoulders[1] - 0.03 * stature:  # a stand-in far below
        neck[2] = shoulders[2] - 0.005 * stature
    # some skeletons have the neck's joint half way up the neck, or the shoulders low on the chest
    neck[1] = np.clip(neck[1], shoulders[1] + 0.01 * stature, shoulders[1] + 0.06 * stature)
    top = np.array([0.0, max(shoulders[1], neck[1] - 0.03 * stature), neck[2]])
    return {"hips": hips, "trunk_top": top, "nape": neck}


def _head(
    points: Mapping[str, Array], roles: Mapping[str, int], stature: float, sole: float
) -> dict:
    """Middle of the skull, where the stature puts it, within what a neck can be."""
    nape = points["nape"]
    rise = np.clip(0.955 * stature - (nape[1] - sole), 0.115 * stature, 0.145 * stature)
    ahead = 0.018 * stature
    if "head" in roles and points["head"][1] > nape[1]:
        above = points["head"] - nape
        rise = np.clip(rise, above[1] + 0.025 * stature, above[1] + 0.100 * stature)
        ahead = float(np.clip(above[2] + 0.014 * stature, 0.014 * stature, 0.032 * stature))
    return {"skull": nape + np.array([0.0, rise, ahead])}
