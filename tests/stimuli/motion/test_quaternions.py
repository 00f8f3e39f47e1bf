"""Rotation kernels against SciPy's, and where closed forms are known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from stimuli.motion import quaternions as quat

ORDERS = ("XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX")


def random_rotations(count: int, seed: int = 0) -> np.ndarray:
    return quat.normalise(np.random.default_rng(seed).normal(size=(count, 4)))


def scipy_of(q: np.ndarray) -> Rotation:
    return Rotation.from_quat(q, scalar_first=True)


def test_products_and_turned_vectors_are_those_of_matrices():
    p, q = random_rotations(200), random_rotations(200, 1)
    v = np.random.default_rng(2).normal(size=(200, 3))
    product = scipy_of(quat.multiply(p, q)).as_matrix()
    assert np.allclose(product, scipy_of(p).as_matrix() @ scipy_of(q).as_matrix(), atol=1e-12)
    assert np.allclose(quat.rotate(q, v), scipy_of(q).apply(v), atol=1e-12)
    identity = quat.multiply(q, quat.inverse(q))
    assert np.allclose(identity, quat.IDENTITY, atol=1e-12)


def test_logarithm_is_half_the_rotation_vector_and_exp_undoes_it():
    q = quat.shorter(random_rotations(200))
    assert np.allclose(2 * quat.log(q), scipy_of(q).as_rotvec(), atol=1e-12)
    assert np.allclose(quat.exp(quat.log(q)), q, atol=1e-12)
    assert np.allclose(quat.exp(np.zeros((2, 3))), quat.IDENTITY)


@pytest.mark.parametrize("order", [*ORDERS, "ZXZ", "XY", "Y"])
def test_euler_angles_are_intrinsic(order: str):
    angles = np.random.default_rng(0).uniform(-4, 4, size=(50, len(order)))
    expected = Rotation.from_euler(order, angles).as_matrix()
    assert np.allclose(scipy_of(quat.from_euler(angles, order)).as_matrix(), expected, atol=1e-12)


def test_zyx_angles_come_back_even_at_gimbal_lock():
    q = random_rotations(500)
    near = np.pi / 2 - np.geomspace(1e-17, 1e-2, 100)
    rng = np.random.default_rng(1)
    locked = quat.from_euler(
        np.stack([rng.uniform(-3, 3, 200), np.append(near, -near), rng.uniform(-3, 3, 200)], -1),
        "ZYX",
    )
    for rotations, tolerance in ((q, 1e-14), (locked, 1e-7)):
        back = quat.from_euler(quat.to_zyx(rotations), "ZYX")
        assert quat.geodesic(back, rotations).max() < tolerance


def test_geodesic_is_half_the_angle_and_keeps_its_precision_when_small():
    p, q = random_rotations(200), random_rotations(200, 1)
    angle = (scipy_of(q).inv() * scipy_of(p)).magnitude()
    assert np.allclose(quat.geodesic(p, q), angle / 2, atol=1e-12)
    assert np.allclose(quat.geodesic(p, -q), angle / 2, atol=1e-12)
    tiny = np.geomspace(1e-12, 1e-3, 10)
    turned = quat.multiply(p[:10], quat.about("X", tiny))
    assert np.allclose(quat.geodesic(p[:10], turned), tiny / 2, rtol=1e-3, atol=1e-16)


@given(st.floats(0, 1), st.floats(-3.1, 3.1))
def test_slerp_turns_evenly_on_the_shorter_arc(weight: float, angle: float):
    start, end = quat.about("Z", 0.0), -quat.about("Z", angle)
    between = quat.slerp(start, end, weight)
    assert quat.geodesic(between, quat.about("Z", weight * angle)) < 1e-7


def test_slerp_of_a_rotation_with_itself_is_itself():
    q = random_rotations(50)
    assert np.abs(quat.slerp(q, q, 0.3) - q).max() < 1e-12


def test_angular_velocity_of_an_even_turn_is_even_to_the_ends():
    turn = quat.about("Y", 0.1 * np.arange(12))
    expected = np.tile([0.0, 0.05, 0.0], (12, 1))
    flipped = turn * np.where(np.arange(12) % 2, -1.0, 1.0)[:, None]
    assert np.allclose(quat.angular_velocity(turn), expected)
    assert np.allclose(quat.angular_velocity(flipped), expected)
    assert np.all(quat.angular_velocity(turn[:1]) == 0)


def test_continuous_signs_keep_neighbours_near():
    turn = quat.about("X", np.linspace(0, 20, 90))
    signs = np.random.default_rng(0).choice([-1.0, 1.0], size=(90, 1))
    steady = quat.continuous((turn * signs)[:, None])[:, 0]
    assert np.all(np.einsum("fi,fi->f", steady[1:], steady[:-1]) > 0)


def test_yaw_is_the_turn_about_the_vertical():
    assert np.isclose(quat.yaw(quat.about("Y", 0.7)), 0.7)
