"""Bodies built once for a skeleton: a table of styles, each a way to give it a skin."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stimuli.errors import InputError
from stimuli.motion.kinematics import forward
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion, Skeleton
from stimuli.render import field
from stimuli.render.appearance import Appearance
from stimuli.render.feet import limited_roll
from stimuli.render.field import body_distance, closed_mesh, outward
from stimuli.render.landmarks import Landmarks, landmarks
from stimuli.render.loft import loft
from stimuli.render.mesh import neighbour_mean, vertex_normals
from stimuli.render.parts import body_parts
from stimuli.render.pointlight import dot_bones, dot_places, dot_skin
from stimuli.render.proportions import shown_skeleton
from stimuli.render.reference import reference_pose
from stimuli.render.rig import Rig, dual_quaternions, make_rig
from stimuli.render.shapes import Floats, Part, bone_weights, distance, place_on_axis
from stimuli.render.skin import Skin
from stimuli.render.sticks import stick_parts

SOFT = 0.010
# Heat flow over the skin, in squares of the height, so that bends are even, and light does not tell
# where one part's bend goes over into another's; as many steps as that takes on the mesh.
BENDS, LIGHT = 0.00066, 0.0002
OCCLUSION = (0.03, 0.06, 0.11, 0.18)
CROWN = 0.054  # of the stature, from the middle of the skull to its top


@dataclass(frozen=True, eq=False)
class Body:
    """A skin, the bones that carry it, and what the look has them do."""

    look: Appearance
    skin: Skin
    rig: Rig
    stature: float  # metres, from the soles to the crown of a standing figure
    casters: Floats  # (C, 3) points of the body in the reference pose, that shade a ground
    casting: Floats  # (C, B) which of the rig's bones carry them

    @property
    def skeleton(self) -> Skeleton:
        """The bones that are drawn."""
        return self.rig.reference.skeleton

    def shown(self, motion: Motion) -> Motion:
        """A motion of the body's skeleton as it is drawn, with the look's proportions."""
        if self.look.proportions == "captured":
            return motion
        return replace(motion, skeleton=self.skeleton, cycle=None)


def make_body(motion: Motion, look: Appearance | None = None) -> Body:
    """A body for the skeleton of `motion`, whose frames may serve to find a stance.

    InputError for a style that is not in the table, or a skeleton without the roles it takes.
    """
    look = look or Appearance()
    if look.style not in STYLES:
        raise InputError(f"style: expected one of {', '.join(STYLES)}, found {look.style!r}.")
    drawn = shown_skeleton(motion, look.proportions)
    reference = reference_pose(replace(motion, skeleton=drawn))
    marks = landmarks(reference)
    rig = make_rig(reference, marks)
    tall = float(marks.points["skull"][1] + CROWN * marks.stature - marks.sole)
    casters, casting = _casters(body_parts(marks), rig)
    return Body(look, STYLES[look.style](rig, marks, look), rig, tall, casters, casting)


def bone_motion(body: Body, motion: Motion) -> NDArray[np.float32]:
    """(F, B, 8) how what carries the skin moves, as dual quaternions from the reference pose.

    These are the bones of the rig, or those of a point-light walker's dots, one each.
    """
    bones = rig_motion(body, motion)
    if body.skin.lit:
        return bones.astype(np.float32)
    return dot_bones(body.rig, body.look, body.stature, bones).astype(np.float32)


def rig_motion(body: Body, motion: Motion) -> Array:
    """(F, B, 8) how the bones of the rig move, feet limited as the look has it."""
    shown = body.shown(motion)
    positions, orientations = forward(shown.skeleton, shown.rotations, shown.root)
    if body.look.foot_roll is not None:
        positions, orientations = limited_roll(
            body.rig, positions, orientations, np.radians(body.look.foot_roll)
        )
    return dual_quaternions(body.rig, positions, orientations)


def skin_mannequin(rig: Rig, marks: Landmarks, look: Appearance) -> Skin:
    """Smooth parts, each with its own skin, merged into one mesh."""
    return _lofted(rig, tuple(map(_set_in, body_parts(marks, look.thickness))))


def _set_in(part: Part) -> Part:
    """A lower limb a little thinner than the upper one: where both end in one ball they flicker."""
    if not part.name.endswith(("forearm", "shank")):
        return part
    return replace(part, widths=SET_IN * part.widths, depths=SET_IN * part.depths)


SET_IN = 0.95


def skin_stick(rig: Rig, marks: Landmarks, look: Appearance) -> Skin:
    """Sticks between the joints, and a ball for the head."""
    return _lofted(rig, stick_parts(marks, look.thickness))


def skin_figure(rig: Rig, marks: Landmarks, look: Appearance) -> Skin:
    """One closed skin over all parts, joined smoothly."""
    parts = body_parts(marks, look.thickness)
    points, faces = closed_mesh(parts)
    weights = _spread(_skin_weights(parts, points, rig, marks.stature), faces, BENDS)
    weights /= weights.sum(axis=1, keepdims=True)
    normals = _spread(outward(parts, points), faces, LIGHT)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return _skin(rig, parts, points, normals, faces, weights)


def skin_dots(rig: Rig, marks: Landmarks, look: Appearance) -> Skin:
    """Dots at places of the body; which bone carries each is settled by `dot_bones`."""
    return dot_skin(len(dot_places(rig, look.dots)))


STYLES: Mapping[str, Callable[[Rig, Landmarks, Appearance], Skin]] = {
    "figure": skin_figure,
    "mannequin": skin_mannequin,
    "stick": skin_stick,
    "point-light": skin_dots,
}


def _lofted(rig: Rig, parts: tuple[Part, ...]) -> Skin:
    points, faces, normals, weights = [], [], [], []
    count = 0
    for part in parts:
        skin, triangles, places = loft(part)
        points.append(skin)
        faces.append(triangles + count)
        normals.append(vertex_normals(skin, triangles))
        weights.append(bone_weights(part, places, rig.names))
        count += len(skin)
    skin, facing, share = (np.concatenate(rows) for rows in (points, normals, weights))
    return _skin(rig, parts, skin, facing, np.concatenate(faces), share)


def _casters(parts: tuple[Part, ...], rig: Rig) -> tuple[Floats, Floats]:
    """Points along the axes of all parts, and the bones that carry them."""
    places = np.linspace(0, 1, CASTERS)
    points = [_lowest(part, places) for part in parts]
    weights = [bone_weights(part, places, rig.names) for part in parts]
    return np.concatenate(points), np.concatenate(weights)


CASTERS = 3  # of each part


def _lowest(part: Part, places: Floats) -> Floats:
    """Points on a part's axis; of a foot, under it on its sole."""
    points = part.start + places[:, None] * (part.end - part.start)
    if part.floor is not None:
        points[:, 1] = part.floor
    return points


def _skin(
    rig: Rig,
    parts: tuple[Part, ...],
    points: Floats,
    normals: Floats,
    faces: NDArray[np.int32],
    weights: Floats,
) -> Skin:
    single = np.float32
    openness = _spread(_openness(parts, points, normals)[:, None], faces, LIGHT)[:, 0]
    return Skin(
        points.astype(single), normals.astype(single), faces, weights.astype(single),
        openness.astype(single), _sides(rig, weights),
    )  # fmt: skip


def _sides(rig: Rig, weights: Floats) -> NDArray[np.float32]:
    """(V,) 1 on the left limbs, −1 on the right ones, 0 on the trunk and the head."""
    signs = [name.startswith("left_") - name.startswith("right_") for name in rig.names]
    return np.asarray(weights @ np.array(signs, dtype=float), dtype=np.float32)


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


def _spread(values: Floats, faces: NDArray[np.int32], area: float) -> Floats:
    """Values (V, n) after heat flow over about `area` of the mesh, in squares of the height."""
    for _ in range(max(1, round(area / field.CELL**2))):
        values = 0.5 * values + 0.5 * neighbour_mean(values, faces)
    return values
