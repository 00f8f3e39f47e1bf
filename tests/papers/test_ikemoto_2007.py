"""Ikemoto, Arikan and Forsyth (2007), section 7: what the score says of captured motion."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from stimuli.collection import collected
from stimuli.motion import Library, Motion
from stimuli.naturalness import (
    WINTER,
    fitted_masses,
    own_plants,
    score_motion,
)
from stimuli.naturalness.spoil import SPOILERS, area_under_roc, slid_feet
from tests.conftest import SHARED

NEAR = 0.05  # metres


@pytest.fixture(scope="module")
def walks_and_runs(motions: Path) -> list[Motion]:
    found = collected(Library([SHARED / "accad_male1_bvh"]))
    return [
        motion
        for name, motion in zip(found.names, found.motions, strict=True)
        if "walk" in name.lower() or "run" in name.lower()
    ]


def near_support(motions: Sequence[Motion], masses: np.ndarray) -> float:
    """The share of supported frames whose zero moment point is within 5 cm of the support."""
    beyond = np.concatenate(
        [score_motion(motion, masses=masses).course.beyond for motion in motions]
    )
    return float((beyond[np.isfinite(beyond)] < NEAR).mean())


def test_captured_walks_and_runs_are_balanced_once_the_masses_are_fitted_7_2(
    walks_and_runs: list[Motion],
) -> None:
    """Of an average body .965 of the frames are; fitted to the half, .96 of the other half."""
    assert near_support(walks_and_runs, WINTER) > 0.94
    masses = fitted_masses(walks_and_runs[::2])
    assert near_support(walks_and_runs[::2], masses) > 0.95
    assert near_support(walks_and_runs[1::2], masses) > 0.9


def test_sample_walks_are_balanced_7_2(sample_motions: Path) -> None:
    names = ("humanoid3d_walk", "0walk_forward", "turn_left0", "turn_right1")
    walks = [Library([sample_motions]).load(name).motion for name in names]
    assert near_support(walks, WINTER) > 0.95


def test_slid_feet_are_told_by_the_plants_of_the_source_7_1(sample_motions: Path) -> None:
    """Plants found in the motion itself would move with the foot: the error would be small."""
    walk = Library([sample_motions]).load("humanoid3d_walk").motion
    rng = np.random.default_rng(5)
    own = own_plants(walk)
    for metres in (0.02, 0.05, 0.1):
        slid = slid_feet(walk, metres, rng)
        by_source, by_itself = score_motion(slid, own).plant, score_motion(slid).plant
        assert by_source is not None
        assert 0.3 * metres < by_source < 0.8 * metres
        assert by_itself is None or by_itself < by_source


@pytest.mark.parametrize("kind", SPOILERS)
def test_spoiled_motion_keeps_its_bones_and_leaves_its_source_alone(
    kind: str, sample_motions: Path
) -> None:
    walk = Library([sample_motions]).load("humanoid3d_walk").motion
    before = walk.rotations.copy()
    spoil, amounts, _ = SPOILERS[kind]
    one, again = (spoil(walk, amounts[-1], np.random.default_rng(3)) for _ in range(2))
    assert one.skeleton is walk.skeleton
    assert np.array_equal(one.rotations, again.rotations)
    assert np.allclose(np.linalg.norm(one.rotations, axis=-1), 1)
    assert np.array_equal(walk.rotations, before)


def test_the_area_under_a_curve_is_the_chance_of_the_right_order() -> None:
    rng = np.random.default_rng(0)
    natural, spoiled = rng.integers(0, 9, 40), rng.integers(2, 12, 30)
    pairs = [1.0 if b > a else 0.5 if a == b else 0.0 for a in natural for b in spoiled]
    assert area_under_roc(natural, spoiled) == pytest.approx(np.mean(pairs))
