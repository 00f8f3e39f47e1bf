"""The zero moment point and momentum of bodies whose answer is known in closed form."""

import numpy as np
import pytest

from stimuli.naturalness.dynamics import (
    GRAVITY,
    Moving,
    angular_momentum,
    half_window,
    in_motion,
    well_derived,
    zero_moment_points,
)

FPS = 30.0
SECONDS = np.arange(60) / FPS
RNG = np.random.default_rng(7)


def points(places: np.ndarray, masses: np.ndarray, floor: float = 0.0) -> np.ndarray:
    """Zero moment points of places (F, S, 3), the ends left out."""
    found, _ = zero_moment_points(in_motion(places, FPS), masses, floor)
    return found[half_window(FPS) : -half_window(FPS)]


def test_a_body_at_rest_is_balanced_below_its_centre_of_mass() -> None:
    body, masses = RNG.uniform(0, 2, (9, 3)), RNG.uniform(1, 9, 9)
    centre = masses @ body / masses.sum()
    found = points(np.broadcast_to(body, (60, 9, 3)), masses)
    assert np.allclose(found, centre[[0, 2]], atol=1e-9)


def test_a_point_mass_that_accelerates_leans_on_a_point_behind_it() -> None:
    """x − ẍ h / g, for every point mass at height h."""
    rate, height = 1.7, 0.9
    x = 0.5 * rate * SECONDS**2
    places = np.stack([x, np.full(60, height), np.zeros(60)], axis=-1)[:, None]
    found = points(places, np.array([70.0]))
    wanted = (x - rate * height / GRAVITY)[half_window(FPS) : -half_window(FPS)]
    assert np.allclose(found[:, 0], wanted, atol=1e-9)
    assert np.allclose(found[:, 1], 0, atol=1e-12)


def test_an_inverted_pendulum_stands_on_its_foot() -> None:
    """At constant height its point falls away from the foot as x = x0 cosh(t √(g/h))."""
    height, foot = 1.0, 0.3
    x = foot + 0.01 * np.cosh(SECONDS * np.sqrt(GRAVITY / height))
    places = np.stack([x, np.full(60, height), np.zeros(60)], axis=-1)[:, None]
    found = points(places, np.array([1.0]))
    assert np.abs(found[:, 0] - foot).max() < 0.01 * (x[-1] - foot)


def test_in_free_fall_the_ground_bears_nothing() -> None:
    places = np.zeros((60, 3, 3))
    places[..., 1] = (5 + 2 * SECONDS - 0.5 * GRAVITY * SECONDS**2)[:, None]
    places[..., 0] = SECONDS[:, None]
    _, borne = zero_moment_points(in_motion(places, FPS), np.ones(3), 0.0)
    assert np.abs(borne).max() < 1e-9


def test_momentum_of_a_spinning_rod_is_known_and_kept_in_flight() -> None:
    """Two masses at ±r that turn at ω have r²ω by mass, wherever their centre goes."""
    spin, arm = 2.0, 0.6
    turn = np.stack([np.cos(spin * SECONDS), np.zeros(60), -np.sin(spin * SECONDS)], axis=-1)
    centre = np.stack(
        [3 * SECONDS, 1 + 4 * SECONDS - 0.5 * GRAVITY * SECONDS**2, -SECONDS], axis=-1
    )
    places = np.stack([centre + arm * turn, centre - arm * turn], axis=1)
    found = angular_momentum(in_motion(places, FPS), np.array([3.0, 3.0]))
    inner = found[well_derived(60, FPS)]
    assert np.allclose(inner, [0, arm**2 * spin, 0], atol=2e-3)


def test_smoothing_leaves_cubics_and_takes_away_noise() -> None:
    places = RNG.normal(size=(4, 1, 3))
    cubic = np.einsum("nf,nsk->fsk", np.stack([SECONDS**n for n in range(4)]), places)
    moving = in_motion(cubic, FPS)
    assert np.allclose(moving.place, cubic, atol=1e-9)
    assert np.allclose(moving.acceleration[30], 2 * places[2] + 6 * SECONDS[30] * places[3])
    noisy = in_motion(RNG.normal(0, 1e-3, (400, 1, 3)), FPS)
    plain = np.diff(RNG.normal(0, 1e-3, (400, 1, 3)), 2, axis=0) * FPS**2
    assert noisy.acceleration.std() < 0.2 * plain.std()


@pytest.mark.parametrize("frames", [4, 5, 8, 9, 30])
def test_short_motions_take_the_window_they_have_room_for(frames: int) -> None:
    moving = in_motion(RNG.normal(size=(frames, 2, 3)), FPS)
    assert isinstance(moving, Moving)
    assert np.isfinite(moving.acceleration).all()


def test_three_frames_have_no_acceleration() -> None:
    with pytest.raises(ValueError, match="3 frames"):
        in_motion(np.zeros((3, 1, 3)), FPS)
