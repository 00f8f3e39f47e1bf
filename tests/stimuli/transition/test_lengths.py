"""Blend lengths against plain readings of the dissertation's formulas."""

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion import Motion
from stimuli.motion import quaternions as quat
from stimuli.ties import first_least
from stimuli.transition import LONGEST, SPECIFICATIONS, blend_length, plots
from stimuli.transition.curves import joint_curves
from stimuli.transition.length import geodesic_costs
from stimuli.transition.lengthmap import length_map, lengths_of
from stimuli.transition.timewarp import timewarp_costs, timewarped
from stimuli.transition.weights import MAJOR, WEIGHTS

SPECS = tuple(SPECIFICATIONS)


def distance(p: np.ndarray, q: np.ndarray, skeleton) -> float:
    """Σ_k w_k θ²_k of two poses (J, 4), one joint after another."""
    return sum(
        weight * float(quat.geodesic(p[skeleton.roles[role]], q[skeleton.roles[role]])) ** 2
        for role, weight in WEIGHTS["wang"].items()
    )


def pose_at(motion: Motion, place: float) -> np.ndarray:
    """A pose at a fractional frame, by slerp."""
    before = min(int(np.floor(place + 1e-9)), len(motion) - 1)
    after = min(before + 1, len(motion) - 1)
    return quat.slerp(motion.rotations[before], motion.rotations[after], place - before)


def test_fixed_is_ten_frames(bodies):
    a = bodies.wandering(30, 0)
    assert blend_length(a, a, 3, 3, "fixed").frames == 10


def test_geodesic_costs_are_v_1_and_v_2(bodies):
    a, b, i, j = bodies.wandering(50, 1), bodies.wandering(60, 2), 20, 33
    costs = geodesic_costs(a, b, i, j, "start-end")
    for frames in (1, 2, 9, 30):
        mean = np.mean([
            distance(a.rotations[i + t - 1], b.rotations[j - frames + t], a.skeleton)
            for t in range(1, frames + 1)
        ])  # fmt: skip
        assert np.isclose(costs[frames - 1], mean)
    assert np.all(np.isnan(costs[30:]))
    assert not np.any(np.isnan(costs[:30]))


def test_center_aligned_costs_run_over_the_frames_mixed(bodies):
    a, b, i, j = bodies.wandering(80, 1), bodies.wandering(80, 2), 40, 33
    costs = geodesic_costs(a, b, i, j, "center-aligned")
    for frames in (1, 4, 5, 12):
        half = frames // 2
        mean = np.mean([
            distance(a.rotations[i + s], b.rotations[j + s], a.skeleton)
            for s in range(-half, half + 1)
        ])  # fmt: skip
        assert np.isclose(costs[frames - 1], mean)


def test_a_motion_that_continues_has_the_length_at_which_it_does(bodies):
    a = bodies.wandering(80, 3)
    found = blend_length(a, a, 20, 20 + 17 - 1, "geodesic")
    assert found.frames == 17
    assert found.report["cost"] < 1e-11


@pytest.mark.parametrize("specification", SPECS)
def test_the_map_gives_the_length_of_every_pair_of_frames(bodies, specification):
    a, b = bodies.wandering(37, 1), bodies.wandering(75, 2)
    frames, least = length_map(a, b, specification)
    for i in range(0, 37, 5):
        for j in range(0, 75, 7):
            costs = geodesic_costs(a, b, i, j, specification)
            assert frames[i, j] == first_least(costs) + 1
            assert np.isclose(least[i, j], np.nanmin(costs))


@pytest.mark.parametrize("specification", SPECS)
def test_the_compiled_map_is_the_plain_one(monkeypatch, specification):
    distances = np.random.default_rng(0).uniform(size=(90, 120))
    plain = lengths_of(distances, specification)
    monkeypatch.setattr("stimuli.transition.lengthmap._MANY", 0)
    compiled = lengths_of(distances, specification)
    assert np.array_equal(plain[0], compiled[0])
    assert np.allclose(plain[1], compiled[1])


@pytest.mark.parametrize("cells", [10**6, 0])
@pytest.mark.parametrize("specification", SPECS)
def test_of_tied_lengths_the_map_takes_the_smallest(monkeypatch, specification, cells):
    monkeypatch.setattr("stimuli.transition.lengthmap._MANY", cells)
    for level in (0.1, 0.7, 1 / 3):
        frames, least = lengths_of(np.full((150, 400), level), specification)
        assert np.all(frames == 1)
        assert np.allclose(least, level)
    below = np.full((150, 400), 0.1)
    below[:20] = np.random.default_rng(0).uniform(10, 100, size=(20, 400))  # sums begin large
    assert np.all(lengths_of(below, specification)[0][20:] == 1)


def test_velocity_is_the_largest_difference_over_the_mean_velocity(bodies):
    a, b, i, j = bodies.wandering(90, 4), bodies.wandering(90, 5), 10, 70
    found = blend_length(a, b, i, j, "velocity")
    joints = a.skeleton.role(*MAJOR)
    differences = [float(quat.geodesic(a.rotations[i, k], b.rotations[j, k])) for k in joints]
    widest = int(np.argmax(differences))
    v, w = (quat.angular_velocity(m.rotations)[f, joints[widest]] for m, f in ((a, i), (b, j)))
    wanted = differences[widest] / np.linalg.norm((v + w) / 2)
    assert found.report["joint"] == MAJOR[widest]
    assert np.isclose(found.report["difference"], differences[widest])
    assert found.frames == np.clip(np.floor(wanted + 0.5), 1, 60)
    speed = (np.linalg.norm(v) + np.linalg.norm(w)) / 2
    steadier = blend_length(a, b, i, j, "velocity-speed")
    assert np.isclose(steadier.report["speed"], speed)


def test_a_velocity_length_is_clamped_to_what_fits_and_says_so(bodies):
    still = bodies.standing(30)
    bent = still.rotations.copy()
    bent[:, still.skeleton.roles["left_knee"]] = quat.about("Z", -0.5)
    found = blend_length(still, Motion(still.skeleton, bent, still.root), 5, 20, "velocity")
    assert (found.frames, found.report["clamped"]) == (21, True)
    assert found.report["joint"] == "left_knee"


@pytest.mark.parametrize("specification", SPECS)
def test_timewarp_costs_are_means_over_stretched_windows(bodies, specification):
    a, b, i, j = bodies.wandering(140, 6), bodies.wandering(140, 7), 62, 70
    pairs, costs = timewarp_costs(a, b, i, j, specification)
    assert np.all(pairs.max(axis=1) <= 2 * pairs.min(axis=1))
    table = {(int(p), int(q)): cost for (p, q), cost in zip(pairs, costs, strict=True)}
    for frames_a, frames_b in ((1, 1), (1, 2), (9, 14), (20, 11), (30, 30)):
        if specification == "start-end":
            count = max(frames_a, frames_b)
            steps = np.linspace(0, 1, count) if count > 1 else np.zeros(1)
            places = [(i + s * (frames_a - 1), j + (s - 1) * (frames_b - 1)) for s in steps]
        else:
            half = max(frames_a // 2, frames_b // 2)
            steps = np.linspace(-1, 1, 2 * half + 1)
            places = [(i + s * (frames_a // 2), j + s * (frames_b // 2)) for s in steps]
        mean = np.mean([distance(pose_at(a, p), pose_at(b, q), a.skeleton) for p, q in places])
        assert np.isclose(table[frames_a, frames_b], mean, atol=1e-10)


def test_timewarp_finds_a_motion_played_at_another_pace(bodies):
    a = bodies.wandering(120, 8)
    places = np.arange(0, 119, 1.5)
    slow = np.array([pose_at(a, place) for place in places])
    fast = Motion(a.skeleton, slow, np.array([a.root[int(place)] for place in places]))
    found = blend_length(a, fast, 30, 40, "timewarp")
    windows = (found.report["from_frames"], found.report["to_frames"])
    assert windows == (31, 21)  # frames 30 … 60 are frames 20 … 40 of the fast one
    assert found.frames == 31


def test_as_printed_the_timewarp_sums_and_favours_one_frame(bodies):
    a, b, i, j = bodies.wandering(90, 1), bodies.wandering(90, 2), 20, 80
    pairs, costs = timewarp_costs(a, b, i, j, "start-end", printed=True)
    table = {(int(p), int(q)): cost for (p, q), cost in zip(pairs, costs, strict=True)}
    total = sum(
        distance(pose_at(a, i + 6 / 9 * t - 1), pose_at(b, j - 9 + t), a.skeleton)
        for t in range(1, 10)
    )
    assert np.isclose(table[6, 9], total)
    assert timewarped(a, b, i, j, "start-end", printed=True).frames == 1


def test_each_joints_own_curve(bodies):
    a, b = bodies.wandering(70, 1), bodies.wandering(70, 2)
    curves = joint_curves(a, b, 10, 60, "start-end")
    assert set(curves) == set(MAJOR)
    weighted = sum(WEIGHTS["wang"][role] * curve for role, curve in curves.items())
    assert np.allclose(weighted, geodesic_costs(a, b, 10, 60, "start-end"), equal_nan=True)


def test_lengths_of_what_does_not_exist_are_refused(bodies):
    a = bodies.wandering(20, 1)
    with pytest.raises(InputError, match="0 to 19"):
        blend_length(a, a, 20, 3, "geodesic")
    with pytest.raises(InputError, match="velocity"):
        blend_length(a, a, 2, 3, "speed")


@pytest.mark.parametrize(
    ("i", "j", "told"),
    [(20, 20, "1 frame, 0.03 s"), (20, 36, "17 frames, 0.57 s"), (20, 0, "1 frame, 0.03 s")],
)
def test_the_picture_shows_every_length_and_names_the_best_inside_its_panel(
    bodies, monkeypatch, tmp_path, i, j, told
):
    drawn = []
    monkeypatch.setattr(plots, "save", lambda figure, path: drawn.append(figure))
    a = bodies.wandering(90, 3)
    plots.draw_lengths(a, a, i, j, "start-end", tmp_path / "length.png")
    (figure,) = drawn
    figure.draw_without_rendering()
    whole, each = figure.axes
    assert whole.get_xlim() == each.get_xlim() == (0, LONGEST + 1)
    (label,) = whole.get_legend().get_texts()
    assert label.get_text() == f"least at {told}"
    panel, box = whole.get_window_extent(), label.get_window_extent()
    assert panel.x0 < box.x0 < box.x1 < panel.x1
    assert panel.y0 < box.y0 < box.y1 < panel.y1


@pytest.mark.parametrize("shape", [(400, 30), (30, 400), (50, 50)])
def test_the_picture_of_a_long_and_a_short_clip_is_no_thread(monkeypatch, tmp_path, shape):
    drawn = []
    monkeypatch.setattr(plots, "save", lambda figure, path: drawn.append(figure))
    plots.draw_cost(np.random.default_rng(0).uniform(size=shape), [], ("a", "b"), tmp_path / "c")
    (figure,) = drawn
    figure.draw_without_rendering()
    panel, (width, height) = figure.axes[0].get_window_extent(), figure.canvas.get_width_height()
    assert panel.width > 0.5 * width
    assert panel.height > 0.5 * height
