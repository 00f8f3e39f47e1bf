"""Bodies built once for a skeleton: a table of ways to give it a skin."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stimuli.motion.skeleton import Motion
from stimuli.render.field import body_distance, closed_mesh, gradient
from stimuli.render.landmarks import Landmarks, landmarks
from stimuli.render.loft import loft, vertex_normals
from stimuli.render.parts import body_parts
from stimuli.render.reference import reference_pose
from stimuli.render.rig import Rig, make_rig
from stimuli.render.shapes import Floats, Part, bone_weights, distance, place_on_axis

SOFT = 0.010
HEAT_ROUNDS = 6
OCCLUSION = (0.03, 0.06, 0.11, 0.18)


@dataclass(frozen=True, eq=False)
class Body:
    """A skin in the reference pose and the bones that carry it."""

    style: str
    points: NDArray[np.float32]  # (V, 3) metres
    normals: NDArray[np.float32]  # (V, 3)
    faces: NDArray[np.int32]  # (T, 3)
    weights: NDArray[np.float32]  # (V, B)
    openness: NDArray[np.float32]  # (V,) 1 in the open, towards 0 in folds
    rig: Rig


def make_body(motion: Motion, style: str = "body") -> Body:
    """A body for the skeleton of `motion`, whose frames may serve to find a stance."""
    reference = reference_pose(motion)
    marks = landmarks(reference)
    return BODIES[style](make_rig(reference, marks), marks)


def figure(rig: Rig, marks: Landmarks) -> Body:
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
    return _body("figure", skin, outward, np.concatenate(faces), share, parts, rig)


def closed_body(rig: Rig, marks: Landmarks) -> Body:
    """One closed skin over all parts, joined smoothly."""
    parts = body_parts(marks)
    points, faces = closed_mesh(parts)
    slope = gradient(parts, points)
    normals = slope / np.linalg.norm(slope, axis=1, keepdims=True)
    weights = _spread(_skin_weights(parts, points, rig, marks.stature), faces)
    return _body("body", points, normals, faces, weights, parts, rig)


BODIES: Mapping[str, Callable[[Rig, Landmarks], Body]] = {"figure": figure, "body": closed_body}


def _body(
    style: str, points: Floats, normals: Floats, faces: NDArray[np.int32], weights: Floats,
    parts: tuple[Part, ...], rig: Rig,
) -> Body:  # fmt: skip
    single = np.float32
    return Body(
        style, points.astype(single), normals.astype(single), faces, weights.astype(single),
        _openness(parts, points, normals).astype(single), rig,
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


def _spread(weights: Floats, faces: NDArray[np.int32]) -> Floats:
    """Weights after a few steps of heat flow over the mesh, so that bends are even."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    count = np.bincount(edges[:, 0], minlength=len(weights))[:, None]
    for _ in range(HEAT_ROUNDS):
        total = np.zeros_like(weights)
        np.add.at(total, edges[:, 0], weights[edges[:, 1]])
        weights = 0.5 * weights + 0.5 * total / count
    return weights / weights.sum(axis=1, keepdims=True)
