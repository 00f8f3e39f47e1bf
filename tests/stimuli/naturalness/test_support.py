"""How far points lie beyond the hulls of soles, against SciPy's hulls."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from stimuli.naturalness.support import Support, beyond_support, rolling


def support(corners: np.ndarray, bears: np.ndarray) -> Support:
    return Support(corners, np.repeat(bears[..., None], 4, axis=-1), bears, 0.0)


def by_hull(point: np.ndarray, corners: np.ndarray) -> float:
    hull = ConvexHull(corners)
    if (hull.equations[:, :2] @ point + hull.equations[:, 2] <= 0).all():
        return 0.0
    ring = corners[hull.vertices]
    sides = np.roll(ring, -1, axis=0) - ring
    along = np.clip(np.vecdot(point - ring, sides) / np.vecdot(sides, sides), 0, 1)
    return float(np.linalg.norm(point - ring - along[:, None] * sides, axis=1).min())


@given(st.integers(0, 2**32 - 1), st.sampled_from([(True, True), (True, False), (False, True)]))
def test_distances_are_those_to_the_hull_of_what_bears(seed: int, feet: tuple[bool, bool]) -> None:
    rng = np.random.default_rng(seed)
    corners = rng.normal(0, 0.3, (20, 2, 4, 2))
    points = rng.normal(0, 0.5, (20, 2))
    found = beyond_support(points, support(corners, np.tile(feet, (20, 1))))
    for point, both, distance in zip(points, corners, found, strict=True):
        wanted = by_hull(point, both[list(feet)].reshape(-1, 2))
        assert abs(distance - wanted) < 1e-9


def test_where_no_foot_bears_nothing_is_told() -> None:
    corners = np.zeros((3, 2, 4, 2))
    bears = np.array([[True, False], [False, False], [False, True]])
    found = beyond_support(np.ones((3, 2)), support(corners, bears))
    assert np.isnan(found[1])
    assert np.allclose(found[[0, 2]], np.sqrt(2))


def test_feet_bear_for_four_frames_before_and_after_they_stand() -> None:
    stands = np.zeros((30, 2), dtype=bool)
    stands[10:15, 0] = True
    bears = rolling(stands, 30.0)
    assert np.flatnonzero(bears[:, 0]).tolist() == list(range(6, 19))
    assert not bears[:, 1].any()
