"""Bollo 2018, inertialization: what a switch leaves decays, and never grows.

The quintic of the talk: x(0) = x₀, x'(0) = v₀, x''(0) = a₀ ≥ 0, and nothing left at t₁, the shorter
of the given length and −5 x₀ / v₀. Of captured joins, with a decay that kept the whole length and
whatever speed there was, up to a quarter had offsets that grew by more than 20 degrees, and knees
bent backwards in up to 18 %.
"""

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stimuli.errors import InputError
from stimuli.motion import Library, Motion, forward, unroll, walker
from stimuli.motion import quaternions as quat
from stimuli.transition import Transition, transition
from stimuli.transition.align import aligned, on_skeleton
from stimuli.transition.decay import clamped, decay_quintic, decay_spring
from tests.conftest import of_captured

PAIRS = (
    ("05_01", "35_02"), ("07_03", "08_03"), ("16_15", "16_31"), ("35_28", "32_01"),
    ("Male1_B3_Walk", "Male1_B15_WalkTurnAround"),
    ("Male1_B9_WalkToTurnLeft90", "Male1_C17_RunTurnAround"),
    ("Male1_C05_WalkToRun", "Male1_C04_RunToWalk"),
    ("Male1_B1_StandToWalk", "Male1_C03_Run"),
)  # fmt: skip
METHODS = ("inertialization", "inertialization-spring")
JOINS = 40
DEGREE = np.radians(1.0)
BACKWARDS = -0.1

sizes = st.floats(1e-6, 3.0)
speeds = st.floats(-3.0, 3.0)
lengths = st.integers(1, 60)


def standing(frames: int) -> Motion:
    """The walker's body in rest."""
    body = walker(0).skeleton
    rotations = np.tile(quat.IDENTITY, (frames, len(body), 1))
    return Motion(body, rotations, np.tile([0.0, 0.89, 0.0], (frames, 1)))


def path(decay, size: float, speed: float, frames: int, steps: int = 1) -> np.ndarray:
    """Sizes at `steps` a frame; a finer path is that of a proportionally slower offset."""
    found = clamped(np.array([size]), np.array([speed / steps]), frames * steps)
    return decay(found.sizes, found.speeds, found.lengths, frames * steps)[:, 0]


@pytest.mark.parametrize("decay", [decay_quintic, decay_spring])
@given(size=sizes, speed=speeds, frames=lengths)
def test_an_offset_falls_from_its_size_to_nothing_and_never_rises(decay, size, speed, frames):
    found = path(decay, size, speed, frames, steps=20)
    assert found[0] == pytest.approx(size)
    assert np.all(np.diff(found) <= 1e-9 * size)
    assert np.all(found >= -1e-9 * size)
    assert found[-1] <= (0.01 if decay is decay_spring else 2e-3) * size


@given(size=sizes, speed=st.floats(-3.0, 0.0), frames=st.integers(4, 60))
def test_the_quintic_has_the_speed_it_is_given_and_ends_at_rest(size, speed, frames):
    found = clamped(np.array([size]), np.array([speed]), frames)
    length = found.lengths[0]
    assert length == pytest.approx(min(frames, -5 * size / speed) if speed < 0 else frames)
    steps = 4000
    fine = decay_quintic(
        found.sizes, found.speeds * length / steps, np.array([float(steps)]), steps
    )
    slope = np.gradient(fine[:, 0], length / steps, edge_order=2)
    bend = np.gradient(slope, length / steps, edge_order=2)
    scale = size / length
    assert slope[0] == pytest.approx(found.speeds[0], abs=2e-3 * scale)
    assert bend[1] >= -0.5 * scale / length
    assert abs(fine[-1, 0]) < 1e-6 * size
    assert abs(slope[-1]) < 1e-2 * scale
    assert abs(bend[-2]) < 0.5 * scale / length


def test_the_published_acceleration_is_clamped():
    """a₀ = max(−(8 v₀ t₁ + 20 x₀) / t₁², 0): slow offsets have none, fast ones that of the talk."""
    for speed, acceleration in ((0.0, 0.0), (-0.02, 0.0), (-0.1, (8 * 0.1 * 40 - 20) / 40**2)):
        found = clamped(np.array([1.0]), np.array([speed]), 40)
        fine = decay_quintic(found.sizes, found.speeds / 1000, found.lengths * 1000, 40_000)[:, 0]
        bend = (fine[0] - 2 * fine[1] + fine[2]) * 1000**2
        assert bend == pytest.approx(acceleration, abs=1e-4)


def test_a_speed_that_leads_away_counts_as_none():
    away, none = (path(decay_quintic, 1.0, speed, 30) for speed in (0.4, 0.0))
    assert np.array_equal(away, none)
    assert clamped(np.array([1.0, 1.0]), np.array([0.4, -0.4]), 30).leading_away == 1


def test_a_spring_does_not_swing_to_the_other_side():
    assert np.all(path(decay_spring, 1.0, -3.0, 60, steps=50) >= 0)


def knee_sines(motion: Motion, rotations: np.ndarray, hinges: np.ndarray | None) -> np.ndarray:
    """Sines (F, 2) of the angle from thigh to shank about the usual axes (2, 3) in the thighs.

    Without axes, these (2, 3) themselves: the mean over the frames.
    """
    places, turns = forward(motion.skeleton, rotations, np.zeros((len(rotations), 3)))
    found = []
    for number, side in enumerate(("left", "right")):
        hip, knee, ankle = motion.skeleton.role(f"{side}_hip", f"{side}_knee", f"{side}_ankle")
        thigh, shank = places[:, knee] - places[:, hip], places[:, ankle] - places[:, knee]
        bend = quat.rotate(quat.inverse(turns[:, hip]), np.cross(thigh, shank))
        if hinges is None:
            found.append(bend.sum(axis=0) / np.linalg.norm(bend.sum(axis=0)))
        else:
            norms = np.linalg.norm(thigh, axis=1) * np.linalg.norm(shank, axis=1)
            found.append(bend @ hinges[number] / norms)
    return np.array(found) if hinges is None else np.array(found).T


def joins(a: Motion, b: Motion, method: str, count: int, seed: int) -> Iterator[Transition]:
    """Joins at drawn frames, by either specification, of the method's own length."""
    rng, made = np.random.default_rng(seed), 0
    while made < count:
        i, j = int(rng.integers(len(a))), int(rng.integers(len(b)))
        specification = ("start-end", "center-aligned")[made % 2]
        with suppress(InputError):
            yield transition(a, b, i, j, method=method, specification=specification)
            made += 1


def assert_no_body_would_refuse(a: Motion, b: Motion, method: str, count: int, seed: int) -> int:
    """No offset grows by a degree, no knee bends backwards that does not do so in a source.

    The root's turn and height are offsets as others are, after alignment. Over the floor its speed
    is A's, a departure: it strays by at most 16/81 of where its speed apart from B's would take it.
    Returns how many joins had knees righted.
    """
    own = on_skeleton(b, a.skeleton).rotations
    hinges = knee_sines(a, np.concatenate([a.rotations, own]), None)
    righted = 0
    for done in joins(a, b, method, count, seed):
        first, last = done.mixed
        found = done.motion.rotations[first : last + 1]
        start = len(own) - (len(done.motion) - first)
        plain = own[start : start + len(found)]
        placed = aligned(a, on_skeleton(b, a.skeleton), first, start)
        rows = slice(start, start + len(found))
        offsets = 2 * quat.geodesic(found, placed.rotations[rows])
        assert np.all(offsets <= offsets[0] + DEGREE), (done.i, done.j)
        apart = done.motion.root[first : last + 1] - placed.root[rows]
        assert np.all(np.abs(apart[:, 1]) <= np.abs(apart[0, 1]) + 1e-9), (done.i, done.j)
        strays = np.hypot(apart[:, 0], apart[:, 2])
        speed = np.zeros(3)
        if first > 0 and start > 0:
            speed = np.diff(a.root[first - 1 : first + 1] - placed.root[start - 1 : start + 1],
                            axis=0)[0]  # fmt: skip
        reach = 16 / 81 * len(found) * np.hypot(speed[0], speed[2])
        assert strays.max() <= reach + 1e-9, (done.i, done.j)
        assert done.report["root_strays_metres"] == pytest.approx(strays.max(), abs=6e-4)
        bent = knee_sines(a, found, hinges).min(axis=0)
        sources = np.minimum(knee_sines(a, plain, hinges).min(axis=0),
                             knee_sines(a, a.rotations[first : first + 1], hinges)[0])  # fmt: skip
        assert not np.any((bent < BACKWARDS) & (sources >= BACKWARDS)), (done.i, done.j)
        righted += done.report["knees_righted"] > 0
    return righted


@pytest.mark.parametrize("method", of_captured(METHODS))
def test_forty_joins_of_each_of_eight_captured_pairs(motions: Path, method):
    library = Library([motions / "cmu_bvh", motions / "accad_male1_bvh"])
    righted = [
        assert_no_body_would_refuse(
            library.load(first).motion, library.load(second).motion, method, JOINS, seed
        )
        for seed, (first, second) in enumerate(PAIRS)
    ]
    assert sum(righted) < 0.1 * JOINS * len(PAIRS)  # the clamps do most of it


@pytest.mark.parametrize("method", METHODS)
def test_joins_of_generated_walkers(method):
    a, b = (unroll(walker(seed), 60, 60)[0] for seed in (0, 1))
    assert_no_body_would_refuse(a, b, method, 20, 3)


@pytest.mark.parametrize("method", METHODS)
def test_a_knee_that_the_offset_would_bend_backwards_comes_to_b_sooner(method):
    """At the switch A's leg is straight and B's bent, which B straightens at once."""
    a, b = standing(60), standing(60)
    knee = a.skeleton.roles["left_knee"]
    bend = np.full(60, -1.2)
    bend[23:] = -0.05
    a.rotations[:, knee] = quat.about("Z", np.full(60, -0.1))
    b.rotations[:, knee] = quat.about("Z", bend)
    done = transition(a, b, 20, 41, method=method, frames=20)
    angles = 2 * np.arcsin(done.motion.rotations[20:42, knee, 3])
    assert angles.max() < 0.1
    assert done.report["knees_righted"] == 1
    assert done.report["decays_shortened"] == 1
    assert done.report["shortest_decay"] < 20


def test_what_was_used_is_reported():
    a, b = (unroll(walker(seed), 20, 40)[0] for seed in (0, 1))
    for method in METHODS:
        told = transition(a, b, 25, 40, method=method, frames=12).report
        assert told["decay"] == {METHODS[0]: "quintic", METHODS[1]: "spring"}[method]
        assert {type(told[key]) for key in ("decays_shortened", "speeds_leading_away")} == {int}
        assert 0 < told["shortest_decay"] <= 12
        assert told["given"]
        assert "departure from Bollo 2018" in told["root_over_floor"]
        assert 0 <= told["root_strays_metres"] < 1
