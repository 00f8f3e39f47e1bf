"""Wang 2005, chapter V: what the blend lengths of captured locomotion look like.

The dissertation's eight chosen pairs had optimal lengths of 5 to 35 frames (V.2.1), and the
example of Fig. V.2, a walk to another walk, one of half a second. Over all pairs of frames of
drawn locomotion pairs an independent count gave 86 % interior optima and 60 % within 5 to 35,
where all windows fit.
"""

from pathlib import Path

import numpy as np
import pytest

from stimuli.motion import Library, Motion
from stimuli.transition import LONGEST, blend_length, transition
from stimuli.transition.align import on_skeleton
from stimuli.transition.curves import joint_curves
from stimuli.transition.distance import cost_matrix
from stimuli.transition.length import geodesic_costs
from stimuli.transition.lengthmap import length_map
from stimuli.transition.points import local_minima

SEED = 2005
GROUPS = {
    "cmu_bvh": (
        "05_01", "06_01", "07_03", "07_04", "07_06", "08_03", "16_15", "16_16", "16_31", "35_02",
        "35_03", "35_04", "35_28", "32_01", "32_02",
    ),
    "accad_male1_bvh": (
        "Male1_B1_StandToWalk", "Male1_B3_Walk", "Male1_B2_WalkToStand", "Male1_B15_WalkTurnAround",
        "Male1_B9_WalkToTurnLeft90", "Male1_B12_WalkTurnRight90", "Male1_C17_RunTurnAround",
        "Male1_C05_WalkToRun", "Male1_C04_RunToWalk",
    ),
}  # fmt: skip
PAIRS = 40


@pytest.fixture(scope="module")
def pairs(motions: Path) -> list[tuple]:
    """Locomotion pairs drawn by the seed, clips of one hierarchy each."""
    rng, drawn = np.random.default_rng(SEED), []
    libraries = {folder: Library([motions / folder]) for folder in GROUPS}
    for n in range(PAIRS):
        folder = tuple(GROUPS)[n % 2]
        a, b = rng.choice(GROUPS[folder], 2, replace=False)
        drawn.append((libraries[folder].load(a).motion, libraries[folder].load(b).motion))
    return drawn


def test_share_of_interior_lengths_and_of_5_to_35_frames(pairs, record_property, capsys):
    lengths = []
    for a, b in pairs:
        frames, _ = length_map(a, b)
        whole = frames[: len(a) - LONGEST + 1, LONGEST - 1 :]  # where all sixty windows fit
        lengths.append(whole.ravel())
    found = np.concatenate(lengths)
    interior = float(np.mean((found > 1) & (found < LONGEST)))
    usual = float(np.mean((found >= 5) & (found <= 35)))
    record_property("interior", interior)
    record_property("from_5_to_35", usual)
    with capsys.disabled():
        print(f"\n{found.size} pairs of frames: {interior:.0%} interior, {usual:.0%} of 5 to 35")
    assert 0.75 < interior < 0.97
    assert 0.45 < usual < 0.80


def test_a_walk_to_a_walk_has_one_clear_minimum_and_the_joints_share_it(motions):
    library = Library([motions / "cmu_bvh"])
    a, b = (library.load(name).motion for name in ("35_01", "35_02"))
    costs = geodesic_costs(a, b, 20, 60, "start-end")
    best = int(np.nanargmin(costs)) + 1
    assert 5 <= best <= 35
    assert np.nanmax(costs) > 10 * np.nanmin(costs)
    curves = joint_curves(a, b, 20, 60, "start-end")
    at = {role: int(np.nanargmin(curve)) + 1 for role, curve in curves.items()}
    shared = [role for role, length in at.items() if abs(length - best) <= 2]
    assert {"left_hip", "right_hip", "left_knee", "right_knee"} <= set(shared)


def test_the_minimum_of_the_cost_is_no_place_for_start_end(pairs):
    ones = []
    for a, b in pairs[:20]:
        minima = local_minima(cost_matrix(a, b), before=LONGEST, after=0)[:1]
        ones += [blend_length(a, b, p.i, p.j, "geodesic").frames for p in minima
                 if p.i + LONGEST <= len(a) and p.j >= LONGEST]  # fmt: skip
    assert not ones or np.median(ones) <= 3


def test_blends_add_no_root_step_at_the_cheapest_points(pairs, capsys):
    """At minima with a second on all sides, where both motions have a blend's window.

    Center-aligned, which is what minima are for. A start-end blend aligns the starts of its
    windows, so a faster B must be caught up with: there a few points exceed the bound.
    """
    worst = {"center-aligned": 0.0, "start-end": 0.0}
    for a, b in pairs:
        own = max(largest_step(m) for m in (a, on_skeleton(b, a.skeleton)))
        found = [p for p in local_minima(cost_matrix(a, b))
                 if 30 <= p.i < len(a) - 30 and 30 <= p.j < len(b) - 30][:10]  # fmt: skip
        for point in found:
            for specification in worst:
                for frames in (5, 10, 20, 30):
                    done = transition(
                        a, b, point.i, point.j, frames=frames, specification=specification
                    )
                    step = largest_step(done.motion) / own
                    worst[specification] = max(worst[specification], step)
    with capsys.disabled():
        print(f"\nlargest root step over the sources' own: {worst}")
    assert worst["center-aligned"] <= 1.1
    assert worst["start-end"] <= 1.5


def largest_step(motion: Motion) -> float:
    return float(np.linalg.norm(np.diff(motion.root, axis=0), axis=1).max())
