"""A body is closed, holds its joints, follows its bones, and keeps its volume."""

from collections import Counter
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion import Motion, forward, load_clip, walker
from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import placed
from stimuli.render import Appearance
from stimuli.render.bodies import STYLES, Body, bone_motion, make_body
from stimuli.render.field import body_distance
from stimuli.render.landmarks import landmarks
from stimuli.render.parts import body_parts
from stimuli.render.reference import reference_pose, swing
from stimuli.render.rig import moved
from stimuli.render.shapes import Part
from stimuli.render.skin import Skin
from tests.conftest import of_captured

SKELETONS = {
    "cmu": "cmu_bvh/02_01.bvh",
    "accad": "accad_male1_bvh/Male1_B3_Walk.bvh",
    "rokoko": "other_bvh/rokoko_jesse_dance.bvh",
    "reactidle": "other_bvh/reactidle_003_genuine.bvh",
    "daz": "other_bvh/cmu_daz_salsa_13.bvh",
}
CORE = ("hip", "knee", "shoulder", "elbow")


@lru_cache(maxsize=1)
def walking() -> Motion:
    return walker(0)


@lru_cache(maxsize=2)
def built(style: str) -> Body:
    return make_body(walking(), Appearance(style=style))


def body(style: str = "figure") -> Body:
    return built(style)


def volume(points: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = (points[faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def edges(faces: np.ndarray) -> np.ndarray:
    return np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def test_the_figure_is_one_closed_surface() -> None:
    faces = body().skin.faces
    directed = Counter(map(tuple, edges(faces).tolist()))
    assert all(directed[b, a] == count for (a, b), count in directed.items())
    assert sum(count > 1 for count in directed.values()) < 0.002 * len(directed)
    assert len(loose_pieces(faces)) == 1


def loose_pieces(faces: np.ndarray) -> set[int]:
    """The lowest vertex of each connected piece."""
    lowest = np.arange(faces.max() + 1)
    while True:
        least = lowest[faces].min(axis=1)
        spread = lowest.copy()
        for corner in range(3):
            np.minimum.at(spread, faces[:, corner], least)
        spread = spread[spread]
        if np.array_equal(spread, lowest):
            return set(lowest.tolist())
        lowest = spread


def test_the_figure_has_the_volume_of_a_slim_adult() -> None:
    litres = volume(body().skin.points.astype(float), body().skin.faces) * 1000
    assert 45 < litres < 80


def test_the_skin_lies_on_the_body_and_reaches_to_its_tips() -> None:
    skin, parts = body().skin, body_parts(landmarks(body().rig.reference))
    assert len(skin.faces) < 9000
    sunk = np.abs(body_distance(parts, skin.points[skin.faces].mean(axis=1).astype(float)))
    assert sunk.mean() < 0.0006
    assert np.percentile(sunk, 99) < 0.003
    for part in parts:
        if part.name.endswith(("hand", "thumb", "toes", "nose")):
            axis = (part.end - part.start) / part.length
            assert _near(skin, part) - part.end @ axis > 0.7 * part.caps[1]


def _near(skin: Skin, part: Part) -> float:
    """How far a skin reaches along a part's axis, near its end."""
    axis = (part.end - part.start) / part.length
    own = np.linalg.norm(skin.points - part.end, axis=1) < 2 * max(*part.caps, part.widths[-1])
    return float((skin.points[own] @ axis).max())


@pytest.mark.parametrize("style", STYLES)
def test_weights_sum_to_one_and_normals_are_unit(style: str) -> None:
    skin = body(style).skin
    np.testing.assert_allclose(skin.weights.sum(axis=1), 1.0, atol=1e-5)
    assert skin.weights.min() >= 0
    np.testing.assert_allclose(np.linalg.norm(skin.normals, axis=1), 1.0, atol=1e-4)
    assert 0 <= skin.openness.min() <= skin.openness.max() <= 1


def test_the_reference_pose_leaves_the_skin_where_it_is() -> None:
    rest = body().rig.reference
    motion = Motion(rest.skeleton, _local(rest)[None], rest.positions[:1])
    bones = bone_motion(body(), motion)[0]
    skin = body().skin
    points, normals = moved(skin.weights, bones, skin.points, skin.normals)
    np.testing.assert_allclose(points, skin.points, atol=1e-5)
    np.testing.assert_allclose(normals, skin.normals, atol=1e-4)


def test_turning_and_moving_the_motion_turns_and_moves_the_skin() -> None:
    shift = np.array([3.0, 0.5, -2.0])
    skin = body().skin
    here = bone_motion(body(), walking()[:1])[0]
    there = bone_motion(body(), placed(walking()[:1], 2.0, shift))[0]
    before, _ = moved(skin.weights, here, skin.points, skin.normals)
    after, _ = moved(skin.weights, there, skin.points, skin.normals)
    wanted = quat.rotate(quat.about("Y", 2.0), before.astype(float)) + shift
    np.testing.assert_allclose(after, wanted, atol=1e-4)


def test_walking_keeps_the_volume() -> None:
    skin = body().skin
    rest = volume(skin.points.astype(float), skin.faces)
    for bones in bone_motion(body(), walking())[::8]:
        points, _ = moved(skin.weights, bones, skin.points, skin.normals)
        assert volume(points.astype(float), skin.faces) == pytest.approx(rest, rel=0.03)


@pytest.mark.parametrize("name", of_captured(SKELETONS))
def test_other_skeletons_stand_upright_with_their_joints_inside(name: str, motions: Path) -> None:
    motion = load_clip(motions / SKELETONS[name]).motion
    reference = reference_pose(motion)
    marks = landmarks(reference)
    joints = [
        reference.positions[marks.joints[f"{side}_{part}"]]
        for side in ("left", "right")
        for part in CORE
    ]
    assert np.all(body_distance(body_parts(marks), np.array(joints)) < 0)
    at = marks.points
    assert at["skull"][1] > at["left_shoulder"][1] > at["left_hip"][1] > at["left_ankle"][1]
    assert at["left_hip"][0] > 0 > at["right_hip"][0]
    assert at["left_ahead"][2] > 0.8
    assert at["skull"][1] - marks.sole == pytest.approx(0.95 * marks.stature, rel=0.06)


def test_an_unknown_style_is_refused_with_the_known_ones() -> None:
    with pytest.raises(InputError, match="figure, mannequin, stick, point-light"):
        make_body(walking(), Appearance(style="skeleton"))


def test_a_swing_takes_one_direction_to_another() -> None:
    generator = np.random.default_rng(3)
    for source, target in generator.normal(size=(20, 2, 3)):
        turned = quat.rotate(swing(source, target), source / np.linalg.norm(source))
        np.testing.assert_allclose(turned, target / np.linalg.norm(target), atol=1e-9)
    up = np.array([0.0, 1.0, 0.0])
    np.testing.assert_allclose(quat.rotate(swing(up, -up), up), -up, atol=1e-12)


def _local(reference: object) -> np.ndarray:
    skeleton, world = reference.skeleton, reference.orientations  # type: ignore[attr-defined]
    local = world.copy()
    for joint, parent in enumerate(skeleton.parents):
        if parent >= 0:
            local[joint] = quat.multiply(quat.inverse(world[parent]), world[joint])
    positions, _ = forward(skeleton, local, reference.positions[0])  # type: ignore[attr-defined]
    np.testing.assert_allclose(positions, reference.positions, atol=1e-9)  # type: ignore[attr-defined]
    return local


@pytest.mark.parametrize("name", of_captured(["cmu", "accad"]))
def test_faces_are_level_and_toes_flat_in_the_usual_posture(name: str, motions: Path) -> None:
    motion = load_clip(motions / SKELETONS[name]).motion
    reference = reference_pose(motion)
    _, orientations = forward(motion.skeleton, motion.rotations, motion.root)
    head = motion.skeleton.roles["head"]
    turned = quat.multiply(orientations[:, head], quat.inverse(reference.orientations[head]))
    face = quat.rotate(turned, np.array([0.0, 0.0, 1.0]))
    assert abs(np.median(face[:, 1])) < 0.03
    assert abs(reference.head_pitch) <= np.radians(20)
    assert abs(reference.neck_tilt) <= np.radians(30)
    toe, ankle = motion.skeleton.role("left_toe", "left_ankle")
    usual = quat.multiply(quat.inverse(reference.orientations[ankle]), reference.orientations[toe])
    between = quat.geodesic(motion.rotations[:, toe], usual)
    assert np.median(between) < np.radians(10)
