"""The bones that carry a skin: joints of the skeleton, and helpers that share out a twist.

A bone is known by how far it has turned and moved from the reference pose; a helper follows its
joint, but takes half of the twist between that joint and a neighbour, as forearms and upper arms
do. Skin between bones is moved by blended dual quaternions (Kavan and others 2008).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.render.landmarks import MIRRORED, Landmarks
from stimuli.render.reference import Reference
from stimuli.render.shapes import Floats

HALF = 0.5
TWISTS = {  # helper: (whose joint it follows, whose twist it takes half of, other end of the bone)
    "shoulder_twist": ("shoulder", "clavicle", "elbow"),
    "elbow_twist": ("elbow", "wrist", "wrist"),
    "hip_twist": ("hip", "pelvis", "knee"),
}
CARRIERS = (
    "clavicle", "shoulder", "elbow", "wrist", "hip", "knee", "ankle", "toe",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Rig:
    """B bones: their joints, the joints whose twist they share, and the reference pose."""

    names: tuple[str, ...]
    joints: np.ndarray  # (B,) int
    twisted: np.ndarray  # (B,) int, the joint itself where no twist is shared
    axes: Array  # (B, 3) unit, the bone's direction in the reference pose
    parents: np.ndarray  # (B,) int, the bone a sign is taken from, -1 for the first
    reference: Reference


def make_rig(reference: Reference, marks: Landmarks) -> Rig:
    """Bones for the trunk, neck, head and four limbs, parents first."""
    rows: dict[str, tuple[int, int, Array]] = {}
    up = np.array([0.0, 1.0, 0.0])
    for k, joint in enumerate(marks.trunk):
        rows[f"trunk{k}"] = (joint, joint, up)
    for role in ("neck", "head"):
        rows[role] = (marks.joints[role], marks.joints[role], up)
    for side, _ in MIRRORED:
        for part in CARRIERS:
            joint = marks.joints[f"{side}_{part}"]
            rows[f"{side}_{part}"] = (joint, joint, up)
        for helper, (part, other, far) in TWISTS.items():
            bone = marks.points[f"{side}_{far}"] - marks.points[f"{side}_{part}"]
            twin = marks.joints["pelvis" if other == "pelvis" else f"{side}_{other}"]
            own = marks.joints[f"{side}_{part}"]
            rows[f"{side}_{helper}"] = (own, twin, bone / np.linalg.norm(bone))
    joints, twisted, axes = zip(*rows.values(), strict=True)
    names = tuple(rows)
    return Rig(
        names, np.array(joints), np.array(twisted), np.array(axes),
        _parents(reference, rows), reference,
    )  # fmt: skip


def _parents(reference: Reference, rows: Mapping[str, tuple[int, int, Array]]) -> np.ndarray:
    """(B,) for each bone an earlier one: its own joint's first bone, or an ancestor joint's."""
    first: dict[int, int] = {}
    parents = []
    for place, (joint, _, _) in enumerate(rows.values()):
        above = joint
        while above >= 0 and above not in first:
            above = int(reference.skeleton.parents[above])
        parents.append(first[above] if above >= 0 else (0 if place else -1))
        first.setdefault(joint, place)
    return np.array(parents)


def dual_quaternions(rig: Rig, positions: Array, orientations: Array) -> Array:
    """(F, B, 8) how each bone has moved from the reference pose: real part, then dual part.

    `positions` (F, J, 3) and `orientations` (F, J, 4) are the joints' in the world.
    """
    rest = rig.reference
    turned = quat.multiply(orientations, quat.inverse(rest.orientations))
    real = turned[:, rig.joints]
    shared = np.flatnonzero(rig.twisted != rig.joints)
    between = quat.multiply(quat.inverse(real[:, shared]), turned[:, rig.twisted[shared]])
    along = np.einsum("fbi,bi->fb", between[..., 1:], rig.axes[shared])
    angle = np.unwrap(2.0 * np.arctan2(along, between[..., 0]), axis=0)
    angle -= 2 * np.pi * np.round(angle[:1] / (2 * np.pi))
    half = HALF * angle[..., None] / 2
    twist = np.concatenate([np.cos(half), np.sin(half) * rig.axes[shared]], axis=-1)
    real[:, shared] = quat.multiply(real[:, shared], twist)
    for bone, parent in enumerate(rig.parents):
        if parent >= 0:
            same = np.einsum("fi,fi->f", real[:, bone], real[:, parent]) >= 0
            real[:, bone] *= np.where(same, 1.0, -1.0)[:, None]
    shift = positions[:, rig.joints] - quat.rotate(real, rest.positions[rig.joints])
    pure = np.concatenate([np.zeros((*shift.shape[:-1], 1)), shift], axis=-1)
    return np.concatenate([real, 0.5 * quat.multiply(pure, real)], axis=-1)


def moved(weights: Floats, bones: Floats, points: Floats, normals: Floats) -> tuple[Floats, Floats]:
    """Points and normals (V, 3) moved by bones (B, 8) blended with weights (V, B), in any dtype."""
    blended = weights @ bones
    real, dual = blended[:, :4], blended[:, 4:]
    scale = 1.0 / np.sqrt(np.einsum("vi,vi->v", real, real))
    real = real * scale[:, None]
    dual = dual * scale[:, None]
    w, r = real[:, :1], real[:, 1:]
    shift = w * dual[:, 1:] - dual[:, :1] * r + _cross(r, dual[:, 1:])
    placed = points + 2.0 * (_cross(r, _cross(r, points) + w * points) + shift)
    turned = normals + 2.0 * _cross(r, _cross(r, normals) + w * normals)
    return placed, turned


def _cross(u: Floats, v: Floats) -> Floats:
    """Cross product (V, 3), keeping the dtype."""
    product = np.empty_like(v)
    product[:, 0] = u[:, 1] * v[:, 2] - u[:, 2] * v[:, 1]
    product[:, 1] = u[:, 2] * v[:, 0] - u[:, 0] * v[:, 2]
    product[:, 2] = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    return product
