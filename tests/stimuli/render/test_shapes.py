"""Distances of parts against closed forms, profiles, and the weights of bones along a part."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stimuli.render.shapes import (
    DENSE,
    Part,
    bone_weights,
    bounds,
    distance,
    place_on_axis,
    profile,
    smooth_union,
)

LEFT, UP, AHEAD = np.eye(3)


def capsule(radius: float = 0.1, length: float = 0.5) -> Part:
    round_ = np.full(DENSE, radius)
    return Part(
        "capsule", np.zeros(3), UP * length, LEFT, round_, round_, np.zeros(DENSE),
        (radius, radius), ((0.0, "a"), (1.0, "b")), "trunk", 0.02,
    )  # fmt: skip


@given(st.lists(st.floats(-1, 1), min_size=3, max_size=3).map(np.array))
def test_distance_to_a_round_capsule_is_exact(point: np.ndarray) -> None:
    on_axis = UP * np.clip(point[1], 0, 0.5)
    true = np.linalg.norm(point - on_axis) - 0.1
    assert distance(capsule(), point[None])[0] == pytest.approx(true, abs=1e-6)


def test_distance_is_zero_on_an_ellipsoid() -> None:
    egg = replace(
        capsule(length=1e-9), widths=np.full(DENSE, 0.2), depths=np.full(DENSE, 0.3),
        caps=(0.4, 0.4),
    )  # fmt: skip
    directions = np.random.default_rng(1).normal(size=(100, 3))
    scaled = directions / np.linalg.norm(directions / [0.2, 0.4, 0.3], axis=1, keepdims=True)
    np.testing.assert_allclose(distance(egg, scaled), 0.0, atol=1e-6)


def test_a_sole_cuts_from_below() -> None:
    cut = replace(capsule(), floor=0.0)
    assert distance(cut, np.array([[0.0, -0.05, 0.0]]))[0] > 0
    assert distance(cut, np.array([[0.0, 0.25, 0.0]]))[0] < 0


def test_bounds_hold_the_part() -> None:
    low, high = bounds(capsule())
    points = np.random.default_rng(2).uniform(-1, 1, (2000, 3))
    inside = points[distance(capsule(), points) < 0]
    assert len(inside)
    assert np.all((inside >= low) & (inside <= high))


@given(st.lists(st.floats(0.01, 0.2), min_size=2, max_size=9))
def test_a_profile_meets_its_values_and_is_flat_at_both_ends(values: list[float]) -> None:
    curve = profile(tuple(values))
    assert curve[0] == pytest.approx(values[0])
    assert curve[-1] == pytest.approx(values[-1])
    steepest = max(np.abs(np.diff(curve)).max(), 1e-9)
    assert abs(curve[1] - curve[0]) <= 0.35 * steepest
    assert abs(curve[-1] - curve[-2]) <= 0.35 * steepest


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(0.001, 0.5))
def test_a_smooth_union_is_at_most_the_nearer_and_close_to_it(
    a: float, b: float, radius: float
) -> None:
    joined = float(smooth_union(np.array(a), np.array(b), radius))
    assert min(a, b) - radius / 4 - 1e-12 <= joined <= min(a, b)
    if abs(a - b) >= radius:
        assert joined == min(a, b)


def test_bones_share_a_part_along_its_axis() -> None:
    points = np.array([[0, -1, 0], [0, 0.25, 0.3], [0, 2, 0]], dtype=float)
    places = place_on_axis(capsule(), points)
    np.testing.assert_allclose(places, [0, 0.5, 1])
    weights = bone_weights(capsule(), places, ("b", "a"))
    np.testing.assert_allclose(weights, [[0, 1], [0.5, 0.5], [1, 0]])
