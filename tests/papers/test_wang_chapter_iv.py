"""Wang 2005, chapter IV: the cost, its insensitivity to ν, its weights."""

from pathlib import Path

import numpy as np
import pytest

from stimuli.motion import Library, Motion
from stimuli.transition.distance import cost_matrix
from stimuli.transition.points import cheapest, local_minima
from stimuli.transition.weights import WEIGHTS

SEED = 2005
WALKS = ("35_01", "35_02", "35_03", "35_04", "16_15", "16_16", "08_01", "08_02", "07_01", "07_02")


@pytest.fixture(scope="module")
def library(motions: Path) -> Library:
    return Library([motions / "cmu_bvh"])


@pytest.fixture(scope="module")
def dances(library: Library) -> tuple[Motion, Motion]:
    """Two dances of one performer (CMU subject 5)."""
    return library.load("05_02").motion, library.load("05_13").motion


def test_table_iv_1_zeroes_all_but_four_limb_joints():
    assert {role.split("_")[1] for role in WEIGHTS["wang"]} == {"hip", "knee", "shoulder", "elbow"}


def test_the_cost_is_spread_over_its_range(dances):
    """IV.2: "the cost function is reasonably uniformly distributed over its ranges"."""
    cost = cost_matrix(*dances, "lee")
    low, high = cost.min(), cost.max()
    assert low > 0
    assert high / low > 20
    quartiles = (np.quantile(cost, [0.25, 0.5, 0.75]) - low) / (high - low)
    assert 0.02 < quartiles[0] < quartiles[1] < quartiles[2] < 0.9


def test_the_optimised_weights_are_more_restrictive(dances):
    """IV.2: "in general, the cost with new weights has become more restrictive"."""
    shares = []
    for weights in ("lee", "wang"):
        cost = cost_matrix(*dances, weights)
        shares.append(np.mean(cost < cost.min() + 0.1 * (cost.max() - cost.min())))
    assert shares[1] > 0
    assert shares[0] > 0


def test_how_far_the_best_point_moves_with_nu(library, dances, capsys):
    """IV.2: "the global minimum for this motion was unchanged as ν was varied from 0 to 100".

    With the velocities of our reading (squared, a frame) it hardly moves for ν up to 1 and moves
    to another minimum where ν is 100 in most pairs: the velocities then outweigh the poses.
    """
    rng = np.random.default_rng(SEED)
    pairs = [dances]
    for _ in range(9):
        a, b = rng.choice(WALKS, 2, replace=False)
        pairs.append((library.load(a).motion, library.load(b).motion))
    moved: dict[float, list[int]] = {0.0: [], 0.1: [], 10.0: [], 100.0: []}
    for a, b in pairs:
        best = cheapest(cost_matrix(a, b))
        for nu, frames in moved.items():
            other = cheapest(cost_matrix(a, b, velocity_weight=nu))
            frames.append(max(abs(best.i - other.i), abs(best.j - other.j)))
    with capsys.disabled():
        for nu, frames in moved.items():
            still = sum(frame == 0 for frame in frames)
            print(
                f"\nν = {nu:g}: {still} of {len(frames)} unmoved, median {np.median(frames):g}",
                end="",
            )
    assert np.median(moved[0.1]) <= 1
    assert np.median(moved[0.0]) <= 2


def test_both_weight_sets_have_a_best_cut_with_room_for_six_seconds(library):
    """IV.4.1: a dance cut at the best point under either set, three seconds before and after."""
    dance = library.load("05_02").motion
    points = {}
    for weights in ("lee", "wang"):
        cost = cost_matrix(dance, dance, weights)
        points[weights] = cheapest(cost, before=90, after=90, trivial=15)
    assert all(p.i >= 90 and p.j < len(dance) - 90 and abs(p.i - p.j) > 15 for p in points.values())
    assert (points["lee"].i, points["lee"].j) != (points["wang"].i, points["wang"].j)


def test_minima_of_a_walk_with_itself_lie_a_cycle_apart(library):
    """The cost knows a gait: the best way back into a walk is one stride on."""
    walk = library.load("35_04").motion
    best = local_minima(cost_matrix(walk, walk), trivial=15)[0]
    assert 28 <= abs(best.i - best.j) <= 40
