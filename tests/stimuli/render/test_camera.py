"""One static camera: everything in frame, as near as it can be."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stimuli.errors import InputError
from stimuli.motion import forward, walker
from stimuli.motion.kinematics import headings
from stimuli.render import Appearance, group_camera
from stimuli.render.bodies import make_body
from stimuli.render.camera import NEAREST, Camera, choose_camera, fit_camera

angles = st.floats(-180, 180)
looks = st.builds(
    Appearance,
    width=st.integers(64, 900),
    height=st.integers(64, 900),
    elevation=st.floats(-20, 60),
    field_of_view=st.floats(10, 80),
    margin=st.floats(0, 0.3),
)


def cloud(seed: int) -> np.ndarray:
    generator = np.random.default_rng(seed)
    return generator.normal(size=(40, 3)) * generator.uniform(0.2, 6, 3)


@given(st.integers(0, 1000), angles, looks)
def test_every_point_is_in_frame_and_the_nearest_ones_touch_the_margin(
    seed: int, yaw: float, look: Appearance
) -> None:
    points = cloud(seed)
    camera = fit_camera(points, np.radians(yaw), look)
    pixels, depth = camera.project(points, look.width, look.height)
    assert np.all(depth > NEAREST - 0.001)
    free = look.margin * np.array([look.width, look.height])
    slack = 0.02 * max(look.width, look.height)  # the place is rounded
    assert np.all(pixels >= free - slack)
    assert np.all(pixels <= [look.width, look.height] - free + slack)
    if depth.min() <= NEAREST + 0.001:
        return
    room = np.minimum(pixels.min(axis=0) - free, [look.width, look.height] - free - pixels.max(0))
    assert room.min() < slack


def test_the_camera_stands_at_its_azimuth_from_the_heading() -> None:
    look = Appearance(azimuth=30, elevation=10, view="front-left")
    ball = np.concatenate([np.eye(3), -np.eye(3)]) * 0.01
    camera = choose_camera(ball, np.radians(20), np.zeros(3), look)
    assert np.degrees(camera.yaw) == pytest.approx(50, abs=0.01)
    assert np.degrees(camera.elevation) == pytest.approx(10, abs=0.01)
    away = np.array(camera.position) / np.linalg.norm(camera.position)
    np.testing.assert_allclose(away, camera.axes[:, 2], atol=0.05)


def test_an_unknown_view_is_refused_with_the_known_ones() -> None:
    with pytest.raises(InputError, match="behind-right"):
        choose_camera(cloud(0), 0.0, np.zeros(3), Appearance(view="above"))


def test_axes_are_orthonormal_and_right_handed() -> None:
    axes = Camera((0, 0, 0), 0.7, 0.3, 0.5).axes
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1)


def test_a_figure_that_runs_off_towards_the_camera_is_seen_from_behind() -> None:
    run = np.linspace([0, 0, 0], [0, 1.8, 0], 2) + np.linspace([0, 0, -3], [0, 0, 12], 9)[:, None]
    look = Appearance()
    chosen = choose_camera(run, 0.0, np.array([0.0, 1, 0]), look)
    assert np.cos(chosen.yaw) < 0
    standing = choose_camera(run[:1], 0.0, np.array([0.0, 1, 0]), look)
    assert np.cos(standing.yaw) > 0


def test_a_group_keeps_all_joints_of_all_motions_in_frame() -> None:
    walk = walker(0)
    other = walker(1)
    look = Appearance(body="parts")
    body = make_body(walk, look.body)
    camera = group_camera(body, [walk, other], look, len(walk) // 2)
    for motion in (walk, other):
        positions, _ = forward(motion.skeleton, motion.rotations, motion.root)
        pixels, _ = camera.project(positions, look.width, look.height)
        assert np.all((pixels > 0) & (pixels < [look.width, look.height]))
    facing = float(headings(walk)[len(walk) // 2])
    assert abs(np.cos(camera.yaw - facing)) == pytest.approx(np.cos(np.radians(35)), abs=1e-3)
