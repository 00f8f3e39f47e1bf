"""Scores of captured and of spoiled motion."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion import Library, Motion
from stimuli.motion.kinematics import placed
from stimuli.naturalness import (
    BODY_PARTS,
    WINTER,
    Source,
    carried_plants,
    fitted_masses,
    own_plants,
    score_motion,
    segment_centres,
)
from stimuli.naturalness.dynamics import GRAVITY, half_window, in_motion, zero_moment_points
from stimuli.naturalness.score import NO_PLANT


@pytest.fixture(scope="module")
def walk(sample_motions: Path) -> Motion:
    return Library([sample_motions]).load("humanoid3d_walk").motion


def test_the_table_sums_to_one_body() -> None:
    assert WINTER.sum() == pytest.approx(1)
    assert len(WINTER) == len(BODY_PARTS) == 12


def test_a_walk_is_balanced_on_feet_that_stand(walk: Motion) -> None:
    found = score_motion(walk)
    assert found.plants >= 3
    assert found.plant is not None
    assert found.zmp is not None
    assert found.score == found.plant + found.zmp
    assert found.plant < 0.01
    assert found.zmp < 0.05
    assert found.remark == ""


def test_where_and_in_which_heading_a_motion_lies_changes_nothing(walk: Motion) -> None:
    moved = score_motion(placed(walk, 2.1, np.array([40.0, 0.0, -7.0]))).as_dict()
    for name, value in score_motion(walk).as_dict().items():
        assert moved[name] == pytest.approx(value, abs=2e-6), name


def test_the_floor_may_lie_at_any_height(walk: Motion) -> None:
    raised = Motion(walk.skeleton, walk.rotations, walk.root + np.array([0, 3.0, 0]), walk.fps)
    assert score_motion(raised).zmp == pytest.approx(score_motion(walk).zmp, abs=1e-9)


def test_zero_moment_points_are_those_of_finite_differences(walk: Motion) -> None:
    """Central differences of the unsmoothed centres, to what smoothing changes."""
    places = segment_centres(walk)
    rates = np.gradient(np.gradient(places, 1 / walk.fps, axis=0), 1 / walk.fps, axis=0)
    pushed = rates[..., 1] + GRAVITY
    plain = np.stack(
        [
            ((pushed * places[..., k] - rates[..., k] * places[..., 1]) @ WINTER)
            / (pushed @ WINTER)
            for k in (0, 2)
        ],
        axis=-1,
    )
    found, _ = zero_moment_points(in_motion(places, walk.fps), WINTER, 0.0)
    inner = slice(half_window(walk.fps), -half_window(walk.fps))
    assert np.median(np.linalg.norm(found - plain, axis=1)[inner]) < 0.03


def test_a_drifting_body_slides_as_far_as_it_drifts(walk: Motion) -> None:
    frames = len(walk)
    own = own_plants(walk)
    source = [Source(walk, np.arange(frames))]
    still = score_motion(walk, carried_plants(walk, source))
    assert still.plants == len(own)
    for slid in (0.02, 0.1, 0.2):
        drift = np.zeros((frames, 3))
        drift[:, 0] = slid * np.sin(np.arange(frames) / 3)
        feet = Motion(walk.skeleton, walk.rotations, walk.root + drift, walk.fps)
        # in the torso frame the feet are where they were: plants of the walk itself tell the slide
        found = score_motion(feet, own)
        assert found.plant is not None
        assert 0.4 * slid < found.plant < slid + 0.01


def test_plants_of_a_motion_made_of_itself_are_its_own(walk: Motion) -> None:
    carried = carried_plants(walk, [Source(walk, np.arange(len(walk)))] * 2)
    for one, other in zip(own_plants(walk), carried, strict=True):
        assert (one.side, one.first, one.last) == (other.side, other.first, other.last)
        assert np.allclose(one.places, other.places, atol=1e-9)


def test_the_nearest_plants_are_taken_and_what_overlaps_is_left_out(walk: Motion) -> None:
    frames = np.arange(len(walk))
    late = np.where(frames >= 3, frames - 3, -1)
    taken = carried_plants(walk, [Source(walk, late), Source(walk, frames)])
    assert max(plant.error for plant in taken if plant.first > 6) < 0.01
    for side in (0, 1):
        spans = sorted((p.first, p.last) for p in taken if p.side == side)
        assert all(one[1] < other[0] for one, other in pairwise(spans))


def test_a_motion_in_which_no_foot_stands_has_no_score(walk: Motion) -> None:
    rushing = walk.root + np.arange(len(walk))[:, None] * [0.5, 0, 0]
    found = score_motion(Motion(walk.skeleton, walk.rotations, rushing, walk.fps))
    assert found.score is None
    assert found.remark == NO_PLANT
    assert found.flight == found.frames


def test_three_frames_are_refused(walk: Motion) -> None:
    with pytest.raises(InputError, match="4 frames or more, found 3"):
        score_motion(walk[:3])


def test_masses_stay_near_the_table_and_sum_to_one(sample_motions: Path, walk: Motion) -> None:
    punch = Library([sample_motions]).load("humanoid3d_punch").motion
    masses = fitted_masses([walk, punch])
    assert masses.sum() == pytest.approx(1)
    assert np.all(masses > 0)
    assert np.all(np.abs(np.log(masses / WINTER)) < 2)
    left = [mass for (_, side), mass in zip(BODY_PARTS, masses, strict=True) if side == "left"]
    right = [mass for (_, side), mass in zip(BODY_PARTS, masses, strict=True) if side == "right"]
    assert left == right
