"""The pose cost: known values, its symmetries, the compiled kernel, and its minima."""

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion import Motion
from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import placed
from stimuli.transition.distance import cost_matrix, exact_angles, pose_distance
from stimuli.transition.kernel import arccos_squared, fused_angles
from stimuli.transition.points import cheapest, default_sigma, local_minima, probabilities
from stimuli.transition.weights import WEIGHTS, read_weights


def test_the_weight_sets_are_those_of_table_iv_1():
    wang, lee = WEIGHTS["wang"], WEIGHTS["lee"]
    assert {wang[f"{s}_hip"] for s in ("left", "right")} == {1.0}
    assert (wang["left_knee"], wang["left_shoulder"], wang["left_elbow"]) == (
        0.0901,
        0.7884,
        0.0247,
    )
    assert set(lee.values()) == {1.0}
    assert len(lee) == 10
    assert {"pelvis", "spine"} <= set(lee)


def test_one_joint_turned_by_an_angle_costs_its_weight_times_half_of_it_squared(bodies):
    still = bodies.standing(3)
    turned = still.rotations.copy()
    hip, knee = still.skeleton.role("left_hip", "right_knee")
    turned[:, hip] = quat.about("Z", 0.8)
    turned[:, knee] = quat.about("Z", -0.6)
    bent = Motion(still.skeleton, turned, still.root - np.array([0.0, 0.1, 0.0]))
    assert np.allclose(pose_distance(still, bent), 0.4**2 + 0.0901 * 0.3**2)
    assert np.allclose(cost_matrix(still, bent), 0.1**2 + 0.4**2 + 0.0901 * 0.3**2)
    assert np.allclose(cost_matrix(still, bent, "lee"), 0.1**2 + 0.4**2 + 0.3**2)


def test_velocities_are_halved_differences_and_turn_with_the_body(bodies):
    still = bodies.standing(9)
    moving = Motion(
        still.skeleton, still.rotations, still.root + np.arange(9)[:, None] * [0.0, 0.0, 0.05]
    )
    turned = placed(moving, 1.1, np.array([3.0, 0.0, 1.0]))
    assert np.allclose(cost_matrix(still, moving), 0.05**2)
    assert np.allclose(cost_matrix(moving, turned), 0.0, atol=1e-12)
    assert np.allclose(cost_matrix(still, moving, velocity_weight=10.0), 10 * 0.05**2)


@pytest.mark.parametrize("weights", ["lee", "wang"])
def test_where_a_motion_stands_and_faces_does_not_matter(bodies, weights):
    a, b = bodies.wandering(20, 1), bodies.wandering(25, 2)
    moved = placed(b, 2.0, np.array([5.0, 0.0, -3.0]))
    assert np.allclose(cost_matrix(a, b, weights), cost_matrix(a, moved, weights), atol=1e-12)
    assert np.allclose(cost_matrix(a, b, weights), cost_matrix(b, a, weights).T, atol=1e-12)
    assert np.allclose(np.diag(cost_matrix(a, a, weights)), 0.0, atol=1e-12)


def test_the_polynomial_is_arccos_squared():
    x = np.linspace(0, 1, 5001)
    for degree, error in ((7, 4e-7), (11, 2e-10)):
        values = np.polynomial.Polynomial(arccos_squared(degree))(x)
        assert np.abs(values - np.arccos(x) ** 2).max() < error


def test_the_compiled_kernel_agrees_with_numpy_to_1e_5():
    rng = np.random.default_rng(0)
    p, q = (quat.normalise(rng.normal(size=(n, 8, 4))) for n in (150, 211))
    q[:20] = -p[:20]  # the same rotations: at the end of the polynomial's range
    weights = rng.uniform(0, 1, 8)
    fused = fused_angles(p, q, weights)
    assert fused.min() >= 0
    assert np.abs(fused - exact_angles(p, q, weights)).max() < 1e-5


def test_large_matrices_go_through_the_kernel(bodies):
    a, b = bodies.wandering(1600, 1), bodies.wandering(1600, 2)
    large = pose_distance(a, b)
    assert large.dtype == np.float32
    assert np.allclose(large[:50, :60], pose_distance(a[:50], b[:60]), atol=1e-5)


def test_minima_are_below_all_eight_neighbours_and_a_plateau_counts_once():
    cost = np.full((7, 9), 5.0)
    cost[2, 3] = 1.0
    cost[5, 6:8] = 2.0
    cost[0, 8] = 0.5
    found = [(point.i, point.j) for point in local_minima(cost)]
    assert found == [(0, 8), (2, 3), (5, 6)]
    flat = np.zeros((4, 4))
    assert [(p.i, p.j) for p in local_minima(flat)] == [(0, 0)]
    sloped = cost.copy()
    sloped[5, 8] = 1.9
    assert (5, 6) not in [(p.i, p.j) for p in local_minima(sloped)]


def test_a_plateau_counts_by_its_first_cell_that_is_not_left_out():
    flat = np.ones((40, 40))
    assert [(p.i, p.j) for p in local_minima(flat, before=5)] == [(5, 0)]
    assert [(p.i, p.j) for p in local_minima(flat, 2, 3, trivial=4)] == [(2, 7)]
    assert local_minima(flat, before=40) == []
    flat[0, 39] = 0.0  # lower beside cells that are left out: no minimum of the others
    assert local_minima(flat, before=5) == []


def plateaus_walked(cost: np.ndarray) -> list[tuple[int, int]]:
    """The first cells of level regions with nothing lower around them, by walking."""
    cells, seen, found = list(np.ndindex(cost.shape)), set(), []
    for start in cells:
        if start in seen:
            continue
        region, waiting, least = set(), [start], np.inf
        while waiting:
            i, j = waiting.pop()
            region.add((i, j))
            for cell in ((i + di, j + dj) for di in (-1, 0, 1) for dj in (-1, 0, 1)):
                if not (0 <= cell[0] < cost.shape[0] and 0 <= cell[1] < cost.shape[1]):
                    continue
                least = min(least, cost[cell])
                if cost[cell] == cost[start] and cell not in region:
                    waiting.append(cell)
        seen |= region
        if least == cost[start]:
            found.append(min(region))
    return sorted(found, key=lambda cell: (cost[cell], cell))


@pytest.mark.parametrize("levels", [2, 3, 6, 30])
def test_plateaus_are_those_found_by_walking(levels):
    rng = np.random.default_rng(levels)
    for shape in ((1, 1), (1, 9), (7, 1), (6, 8), (9, 9), (12, 5)):
        cost = rng.integers(levels, size=shape).astype(float)
        assert [(p.i, p.j) for p in local_minima(cost)] == plateaus_walked(cost)


def test_minima_agree_with_a_plain_search():
    cost = np.random.default_rng(3).uniform(size=(30, 40))
    padded = np.pad(cost, 1, constant_values=np.inf)
    plain = {
        (i, j)
        for i in range(30)
        for j in range(40)
        if cost[i, j] == padded[i : i + 3, j : j + 3].min()
    }
    assert {(p.i, p.j) for p in local_minima(cost)} == plain
    least = cheapest(cost)
    assert (least.i, least.j) == np.unravel_index(cost.argmin(), cost.shape)


def test_room_and_triviality_exclude_cells():
    cost = np.random.default_rng(4).uniform(size=(30, 30))
    roomy = local_minima(cost, before=10, after=8, trivial=3)
    assert roomy
    assert all(p.i >= 10 and p.j < 22 and abs(p.i - p.j) > 3 for p in roomy)
    assert cheapest(cost, before=30) is None


@pytest.mark.parametrize(("before", "after"), [(0, 30), (0, 45), (30, 0), (100, 100)])
def test_more_room_than_there_is_leaves_no_point(before, after):
    cost = np.random.default_rng(4).uniform(size=(30, 30))
    assert local_minima(cost, before, after) == []
    assert cheapest(cost, before, after) is None


def test_probabilities_follow_the_cost_of_the_frame_before():
    cost = np.random.default_rng(5).uniform(size=(6, 9))
    likely = probabilities(cost, sigma=0.2)
    assert np.allclose(likely.sum(axis=1), 1.0)
    assert np.all(likely[:, 0] == 0)
    ratio = likely[2, 4] / likely[2, 7]
    assert np.isclose(ratio, np.exp((cost[2, 6] - cost[2, 3]) / 0.2))


def test_a_tiny_sigma_leaves_the_cheapest_alone():
    cost = np.random.default_rng(5).uniform(size=(6, 9))
    likely = probabilities(cost, sigma=1e-300)
    assert np.array_equal(likely.argmax(axis=1), cost[:, :-1].argmin(axis=1) + 1)
    assert np.array_equal(likely.max(axis=1), np.ones(6))


def test_sigma_is_the_mean_of_the_cheapest_costs_where_a_motion_leads_elsewhere():
    cost = np.array([[1.0, 2.0, 9.0], [4.0, 3.0, 5.0]])
    assert default_sigma(cost) == 2.0
    itself = np.abs(np.subtract.outer(np.arange(9.0), np.arange(9.0)))
    assert default_sigma(itself, trivial=3) == 4.0 * 8 / 8
    assert default_sigma(itself) == 1.0  # no cost anywhere to go by


def test_weights_are_read_from_files(tmp_path):
    path = tmp_path / "w.toml"
    path.write_text("[weights]\nhip = 1.0\nleft_knee = 0.5\npelvis = 0.25\n")
    weights = read_weights(str(path))
    assert dict(weights) == {"left_hip": 1.0, "right_hip": 1.0, "left_knee": 0.5, "pelvis": 0.25}


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("w.toml", "nose = 1.0", "nose"),
        ("w.toml", "hip = -1.0", "hip: .*-1.0"),
        ("w.toml", "hip = true", "hip: .*True"),
        ("w.toml", "hip = nan", "hip: .*nan"),
        ("w.toml", "hip = inf\nknee = 'x'", "hip: .*inf; knee: .*'x'"),
        ("w.toml", "hip = 0.0", "above 0"),
        ("w.toml", "hip = [", "expected weights"),
        ("w.json", "[1, 2]", r"role = weight, found \[1, 2\]"),
        ("w.json", '{"weights": 3}', "role = weight, found 3"),
        ("w.json", "null", "role = weight, found None"),
        ("w.json", "[" * 100_000, "expected weights"),
    ],
)
def test_weights_that_are_none_are_refused_with_file_and_key(tmp_path, name, text, told):
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(InputError, match=told) as refusal:
        read_weights(str(path))
    assert str(path) in str(refusal.value)
    assert len(str(refusal.value).splitlines()) <= 2
