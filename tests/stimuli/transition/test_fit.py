"""Weights from labelled transitions: known weights come back; leaving one out moves little."""

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion.skeleton import Motion, Skeleton
from stimuli.transition import fit as fitting
from stimuli.transition.distance import cost_matrix, root_cost
from stimuli.transition.fit import (
    Labelled,
    LeftOut,
    common_parts,
    design_matrix,
    fit_weights,
    leave_one_out,
    part_distances,
    summary,
)
from stimuli.transition.points import TransitionPoint

PARTS = ("shoulder", "elbow", "hip", "knee", "pelvis")


def test_rows_are_position_plus_velocity_differences_of_both_sides(bodies):
    a, b = bodies.wandering(30, 1), bodies.wandering(30, 2)
    weights = {"hip": 1.0, "knee": 0.0901, "shoulder": 0.7884, "elbow": 0.0247}
    distances = part_distances(a, b, tuple(weights))
    total = root_cost(a, b) + np.tensordot(list(weights.values()), distances, axes=1)
    assert np.allclose(total, cost_matrix(a, b, "wang"), atol=1e-12)
    rows, labels = design_matrix([Labelled(a, b, 0, 29, True), Labelled(a, b, 9, 4, False)], PARTS)
    whole = part_distances(a, b, PARTS)
    assert np.allclose(rows, [whole[:, 0, 29], whole[:, 9, 4]])
    assert labels.tolist() == [0.0, 1.0]


def test_known_weights_come_back_from_their_own_costs():
    rng = np.random.default_rng(0)
    differences = rng.gamma(1.0, 0.3, (60, 5))
    truth = np.array([0.8, 0.0, 1.0, 0.1, 0.0])
    fit = fit_weights(differences, 0.5 * differences @ truth, PARTS)
    assert np.allclose(fit.weights, truth, atol=1e-9)
    assert fit.residual < 1e-12
    roles = fit.by_role()
    assert roles["left_hip"] == roles["right_hip"] == pytest.approx(1.0)


def test_known_weights_come_back_from_simulated_labels():
    rng = np.random.default_rng(1)
    truth = np.array([0.8, 0.0, 1.0, 0.1, 0.0])
    differences = rng.gamma(0.7, 0.4, (6000, 5))
    cost = differences @ truth
    labels = (rng.uniform(size=len(cost)) < np.clip(cost, 0, 1)).astype(float)
    mild = cost < 1  # where the chance of being called bad is the cost itself
    fit = fit_weights(differences[mild], labels[mild], PARTS)
    assert np.abs(fit.weights - truth).max() < 0.12


def test_leaving_one_out_moves_the_best_point_little(bodies):
    rng = np.random.default_rng(2)
    motions = [bodies.wandering(40, seed) for seed in range(4)]
    labelled = []
    for a, b in ((motions[0], motions[1]), (motions[1], motions[2])):
        cost = cost_matrix(a, b)
        for good, cells in (
            (True, np.argwhere(cost < np.quantile(cost, 0.05))),
            (False, np.argwhere(cost > np.quantile(cost, 0.6))),
        ):
            picked = rng.choice(cells, 8)
            labelled += [Labelled(a, b, int(i), int(j), good) for i, j in picked]
    told: list[int] = []
    other = (motions[3], motions[0])
    own, foreign = leave_one_out(labelled, PARTS, other=other, progress=told.append)
    assert len(own) == len(foreign) == len(labelled) == told[-1]
    assert summary(own)["median"] == 0
    assert summary(foreign)["unmoved"] > len(labelled) / 2


def told_apart(bodies, good: int, bad: int) -> list[Labelled]:
    """Labels of one pair of motions by its cost: good at the cheapest cells, bad at the dearest."""
    a, b = bodies.wandering(40, 0), bodies.wandering(40, 1)
    order = np.argsort(cost_matrix(a, b), axis=None)
    picked = [*((n, True) for n in order[:good]), *((n, False) for n in order[-bad:])]
    return [Labelled(a, b, *map(int, np.unravel_index(n, (40, 40))), kind) for n, kind in picked]


@pytest.mark.parametrize(("good", "bad"), [(1, 5), (5, 1), (1, 1)])
def test_a_label_that_is_the_only_one_of_its_kind_stays(bodies, good, bad):
    labelled = told_apart(bodies, good, bad)
    other = (labelled[0].b, labelled[0].a)
    for entries in leave_one_out(labelled, PARTS, other=other):
        alone = [left.row for left in entries if left.moved is None]
        assert alone == [row for row, t in enumerate(labelled) if (good, bad)[not t.good] == 1]
        assert all("only one" in left.reason for left in entries if left.moved is None)
        told = summary(entries)
        assert told["count"] == good + bad - len(alone)
        assert (told["mean"] is None) == (told["count"] == 0)


def test_the_best_points_have_the_room_that_is_wanted(bodies):
    labelled = told_apart(bodies, 4, 4)
    own, _ = leave_one_out(labelled, PARTS, before=12, after=9)
    for left in own:
        for point in (left.best, left.without):
            assert point.i >= 12
            assert point.j < 31
    with pytest.raises(InputError, match="40 frames before"):
        leave_one_out(labelled, PARTS, before=40)


def test_labels_that_say_nothing_are_refused(bodies):
    a = bodies.wandering(20, 1)
    parts = common_parts([a])
    assert set(PARTS) <= set(parts)
    rows, labels = design_matrix([Labelled(a, a, 1, 9, True), Labelled(a, a, 2, 5, True)], parts)
    with pytest.raises(InputError, match="one kind"):
        fit_weights(rows, labels, parts)
    with pytest.raises(InputError, match="differ"):
        fit_weights(np.zeros((2, len(parts))), np.array([0.0, 1.0]), parts)


@pytest.mark.parametrize("cells", [1, 5 * 40 * 7, 10**9])
def test_blocks_of_any_size_find_the_same_points(bodies, monkeypatch, cells):
    labelled = told_apart(bodies, 4, 4)
    labelled += [Labelled(t.a, t.a, t.i, t.j, t.good) for t in labelled[:6]]
    parts = common_parts([labelled[0].a])
    monkeypatch.setattr(fitting, "CELLS", cells)
    told: list[int] = []
    own, _ = leave_one_out(labelled, parts, progress=told.append, before=3, after=2)
    assert told == sorted(told)
    weights = fit_weights(*design_matrix(labelled, parts), parts).weights
    for left, t in zip(own, labelled, strict=True):
        cost = root_cost(t.a, t.b) + np.tensordot(weights, part_distances(t.a, t.b, parts), axes=1)
        if t.a is t.b:
            frames = np.arange(len(t.a))
            cost[np.abs(frames[:, None] - frames) <= 15] = np.inf
        room = cost[3:, :-2]
        i, j = np.unravel_index(np.argmin(room), room.shape)
        assert (left.best.i, left.best.j) == (i + 3, j)


def test_moves_go_the_shorter_way_round_a_loop():
    left = LeftOut(0, TransitionPoint(1, 5, 0.0), TransitionPoint(31, 8, 0.0), periods=(32.0, None))
    assert left.moved == 3
    assert LeftOut(0, TransitionPoint(1, 5, 0.0), TransitionPoint(31, 8, 0.0)).moved == 30
    assert (
        LeftOut(
            0, TransitionPoint(0, 5, 0.0), TransitionPoint(32, 5, 0.0), periods=(32.3, 32.3)
        ).moved
        == 0
    )


def test_parts_that_share_a_joint_in_any_motion_are_one(bodies):
    a = bodies.wandering(5, 1)
    skeleton = a.skeleton
    roles = dict(skeleton.roles) | {"spine": skeleton.roles["pelvis"]}
    other = Skeleton(
        skeleton.names, skeleton.parents, skeleton.offsets, skeleton.end_parents,
        skeleton.end_offsets, roles,
    )  # fmt: skip
    assert "spine" in common_parts([a])
    assert "spine" not in common_parts([a, Motion(other, a.rotations, a.root)])
