"""A camera that stands: everything in frame, as near as it can be."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stimuli.render import Appearance
from stimuli.render.camera import NEAREST, OFF_MIDDLE, Camera, fit_camera

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
    camera = fit_camera(points[None], np.radians(yaw), look)
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


def test_axes_are_orthonormal_and_right_handed() -> None:
    axes = Camera((0, 0, 0), 0.7, 0.3, 0.5).axes
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1)


def test_figures_stand_in_the_middle_of_the_height_on_average() -> None:
    """One that jumps high is held, but stands on the ground most of the time."""
    stands = np.array([[x, y, 0.0] for x in (-0.2, 0.2) for y in (0.0, 1.7)])
    frames = np.stack([stands] * 9 + [stands + np.array([0.0, 1.2, 0.0])])
    look = Appearance(width=640, height=480, margin=0.03)
    pixels, _ = fit_camera(frames, 0.0, look).project(frames, 640, 480)
    middle = (pixels[..., 1].max(axis=1) + pixels[..., 1].min(axis=1)).mean() / 2 / 480
    assert abs(middle - 0.5) < OFF_MIDDLE + 0.01
    assert pixels[..., 1].min() >= 0.03 * 480 - 1
    alone = fit_camera(frames[:1], 0.0, look).project(frames[:1], 640, 480)[0]
    assert np.ptp(alone[..., 1]) > 1.4 * np.ptp(pixels[0, :, 1])


def test_a_camera_that_moves_sees_as_the_standing_ones_of_its_frames() -> None:
    moves = ((0.0, 0.0, 0.0), (0.5, -1.0, 0.2), (1.0, 2.0, -0.4))
    camera = Camera((1.0, 1.5, 6.0), 0.3, 0.1, 0.4, "pan", moves)
    points = np.random.default_rng(4).normal(size=(3, 5, 3))
    pixels, depth = camera.project(points, 320, 240)
    for frame in range(3):
        one, away = camera.at(frame).project(points[frame], 320, 240)
        np.testing.assert_allclose(pixels[frame], one, atol=1e-9)
        np.testing.assert_allclose(depth[frame], away, atol=1e-12)
    np.testing.assert_allclose(
        camera.seen(points[[2, 0]], np.array([2, 0])), camera.seen(points)[[2, 0]], atol=1e-12
    )


def test_size_is_the_height_of_what_stands_there_in_pixels() -> None:
    camera = Camera((0.0, 0.85, 5.0), 0.0, 0.0, 0.5)
    rod = np.array([[0.3, 0.0, -1.0], [0.3, 1.7, -1.0]])
    pixels, _ = camera.project(rod, 640, 480)
    share = camera.size_of(1.7, rod.mean(axis=0))
    assert float(share) == pytest.approx(np.ptp(pixels[:, 1]) / 480, rel=1e-9)
