"""The least of costs that only rounding tells apart is the first of them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stimuli.motion import Motion, walker
from stimuli.motion import quaternions as quat
from stimuli.render.appearance import Appearance
from stimuli.render.staging import Staging, choose_camera
from stimuli.ties import ROUNDING, first_least, ranks
from stimuli.transition import blend_length, with_room
from stimuli.transition.points import cheapest, local_minima

levels = st.lists(st.integers(0, 3), min_size=1, max_size=40)


@given(levels, st.integers(0, 2**32 - 1))
def test_rounding_decides_neither_the_least_nor_the_order(whole: list[int], seed: int) -> None:
    noise = np.random.default_rng(seed).uniform(-0.2, 0.2, len(whole)) * ROUNDING
    costs = np.array(whole) * 0.1 + noise
    assert first_least(costs) == whole.index(min(whole))
    places = sorted(set(whole))
    assert ranks(costs.tolist()) == [places.index(level) for level in whole]


def test_what_is_none_is_not_the_least() -> None:
    assert first_least([np.nan, 2.0, 1.0, 1.0]) == 2
    assert first_least(np.array([[3.0, np.inf], [np.inf, 2.0]])) == 3
    assert ranks([]) == []
    with pytest.raises(ValueError, match="NaN"):
        first_least([np.nan, np.nan])


def test_levels_do_not_grow_into_one_another() -> None:
    chain = [n * 0.8 * ROUNDING for n in range(5)]
    assert ranks(chain) == [0, 0, 1, 1, 2]


def test_points_of_one_cost_stand_in_the_order_of_their_places() -> None:
    """A motion's cost with itself is its own mirror image, but for the last digits."""
    rng = np.random.default_rng(0)
    cost = rng.uniform(1, 2, (40, 40))
    cost = cost + cost.T
    upper = cost + 1e-15 * np.triu(rng.standard_normal((40, 40)), 1)
    lower = cost + 1e-15 * np.tril(rng.standard_normal((40, 40)), -1)
    found = [[(p.i, p.j) for p in local_minima(c)] for c in (cost, upper, lower)]
    assert found[0] == found[1] == found[2]
    assert any(found[0][n] == found[0][n + 1][::-1] for n in range(len(found[0]) - 1))
    best = [cheapest(c) for c in (cost, upper, lower)]
    assert len({(point.i, point.j) for point in best if point}) == 1


@pytest.mark.parametrize("method", ["geodesic", "timewarp", "per-joint", "velocity"])
@pytest.mark.parametrize("specification", ["start-end", "center-aligned"])
def test_lengths_are_the_same_for_motions_that_are_nearly(method: str, specification: str) -> None:
    """Also of a motion with itself, where every length is as good as every other."""
    rng = np.random.default_rng(5)
    a, i = with_room(walker(0), 12)
    b, j = with_room(walker(1), 20)
    for second, at in ((b, j), (a, i)):
        lengths = set()
        for _ in range(8):
            first, other = (
                Motion(m.skeleton, quat.normalise(
                    m.rotations + 1e-15 * rng.standard_normal(m.rotations.shape)), m.root, m.fps)
                for m in (a, second)
            )  # fmt: skip
            lengths.add(blend_length(first, other, i, at, method, specification).frames)
        assert len(lengths) == 1


def staged(outlines: np.ndarray, roots: np.ndarray) -> Staging:
    """Frames that all are near a blend, of a figure 1.7 m tall that stays where it is."""
    count = len(outlines)
    return Staging(
        outlines,
        roots,
        np.arange(count),
        np.ones(count, dtype=bool),
        np.zeros((count, 2)),
        0.0,
        1.7,
    )


def test_of_two_views_that_show_as_much_the_first_is_taken() -> None:
    """A figure that is its own mirror image looks as large from the left as from the right."""
    side = np.array([[0.3, y, z] for y in (0.0, 1.7) for z in (-0.2, 0.4)])
    both = np.concatenate([side, side * [-1, 1, 1]])
    look = Appearance(width=640, height=480, camera="fixed")
    staging = staged(both[None], np.array([[0.0, 0.9, 0.0]]))
    seen = {
        choose_camera(replace(staging, outlines=both[None] + noise), look).yaw
        for noise in np.random.default_rng(2).standard_normal((20, *both.shape)) * 1e-12
    }
    assert len(seen) == 1
    assert seen.pop() > 0
