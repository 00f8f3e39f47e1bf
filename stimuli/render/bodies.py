"""Bodies built once for a skeleton: a table of ways to give it a skin."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stimuli.errors import InputError
from stimuli.motion.kinematics import forward
from stimuli.motion.skeleton import Motion
from stimuli.render.field import body_distance, closed_mesh
from stimuli.render.landmarks import Landmarks, landmarks
from stimuli.render.loft import loft
from stimuli.render.mesh import neighbour_mean, vertex_normals
from stimuli.render.parts import body_parts
from stimuli.render.reference import reference_pose
from stimuli.render.rig import Rig, dual_quaternions, make_rig
from stimuli.render.shapes import Floats, Part, bone_weights, distance, place_on_axis

SOFT = 0.010
HEAT_ROUNDS = 6
OCCLUSION = (0.03, 0.06, 0.11, 0.18)


@dataclass(frozen=True, eq=False)
class Skin:
    """A closed surface in the reference pose, and which bones carry each of its points."""

    points: NDArray[np.float32]  # (V, 3) metres
    normals: NDArray[np.float32]  # (V, 3)
    faces: NDArray[np.int32]  # (T, 3)
    weights: NDArray[np.float32]  # (V, B)
    openness: NDArray[np.float32]  # (V,) 1 in the open, towards 0 in folds


@dataclass(frozen=True, eq=False)
class Body:
    """A skin and the bones that carry it."""

    style: str
    skin: Skin
    rig: Rig


def make_body(motion: Motion, style: str = "figure") -> Body:
    """A body for the skeleton of `motion`, whose frames may serve to find a stance.

    InputError for a style that is not in the table, or a skeleton without the roles it takes.
    """
    if style not in BODIES:
        raise InputError(f"body: expected one of {', '.join(BODIES)}, found {style!r}.")
    reference = reference_pose(motion)
    marks = landmarks(reference)
    rig = make_rig(reference, marks)
    return Body(style, BODIES[style](rig, marks), rig)


def bone_motion(body: Body, motion: Motion) -> NDArray[np.float32]:
    """(F, B, 8) how the body's bones move, as dual quaternions from the reference pose."""
    positions, orientations = forward(motion.skeleton, motion.rotations, motion.root)
    return dual_quaternions(body.rig, positions, orientations).astype(np.float32)


def skin_parted(rig: Rig, marks: Landmarks) -> Skin:
    """Smooth parts, each with its own skin, merged into one mesh."""
    points, faces, normals, weights = [], [], [], []
    count = 0
    parts = body_parts(marks)
    for part in parts:
        skin, triangles, places = loft(part)
        points.append(skin)
        faces.append(triangles + count)
        normals.append(vertex_normals(skin, triangles))
        weights.append(bone_weights(part, places, rig.names))
        count += len(skin)
    skin, outward, share = (np.concatenate(rows) for rows in (points, normals, weights))
    return _skin(parts, skin, outward, np.concatenate(faces), share)


def skin_closed(rig: Rig, marks: Landmarks) -> Skin:
    """One closed skin over all parts, joined smoothly."""
    parts = body_parts(marks)
    points, faces = closed_mesh(parts)
    weights = _spread(_skin_weights(parts, points, rig, marks.stature), faces)
    weights /= weights.sum(axis=1, keepdims=True)
    return _skin(parts, points, vertex_normals(points, faces), faces, weights)


BODIES: Mapping[str, Callable[[Rig, Landmarks], Skin]] = {
    "figure": skin_closed,
    "parts": skin_parted,
}


def _skin(
    parts: tuple[Part, ...],
    points: Floats,
    normals: Floats,
    faces: NDArray[np.int32],
    weights: Floats,
) -> Skin:
    single = np.float32
    openness = _spread(_openness(parts, points, normals)[:, None], faces, rounds=2)[:, 0]
    return Skin(
        points.astype(single), normals.astype(single), faces, weights.astype(single),
        openness.astype(single),
    )  # fmt: skip


def _openness(parts: tuple[Part, ...], points: Floats, normals: Floats) -> Floats:
    """(V,) how free the space above the skin is, from the field at a few heights above it."""
    closed = np.zeros(len(points))
    for place, height in enumerate(OCCLUSION):
        free = body_distance(parts, points + height * normals)
        closed += np.clip(1 - free / height, 0, 1) * 0.5**place
    return np.clip(1 - 0.55 * closed, 0.0, 1.0)


def _skin_weights(parts: tuple[Part, ...], points: Floats, rig: Rig, stature: float) -> Floats:
    """(V, B) weights of each part's bones, by how near each part is to each point."""
    gaps = np.stack([distance(part, points) for part in parts])
    near = np.exp(-(gaps - gaps.min(axis=0)) / (SOFT * stature))
    near[near < 1e-3] = 0.0
    near /= near.sum(axis=0)
    weights = np.zeros((len(points), len(rig.names)))
    for part, share in zip(parts, near, strict=True):
        weights += share[:, None] * bone_weights(part, place_on_axis(part, points), rig.names)
    return weights


def _spread(values: Floats, faces: NDArray[np.int32], rounds: int = HEAT_ROUNDS) -> Floats:
    """Values (V, n) after a few steps of heat flow over the mesh, so that bends are even."""
    for _ in range(rounds):
        values = 0.5 * values + 0.5 * neighbour_mean(values, faces)
    return values
