"""The cost of appendix A, against its definition, and the edges under a threshold."""

from itertools import pairwise

import numpy as np
import pytest

from stimuli.collection import torso_features
from stimuli.graph.cost import (
    RATES,
    SMALLEST,
    cut_costs,
    largest_steps,
    metric_of,
    weighted_columns,
)
from stimuli.graph.edges import cut_space
from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import forward, heading, placed


def plain_features(motion, joints, frame):
    """D's columns and their rates at one frame, by the definition, with loops."""

    def at(f):
        f = min(f, len(motion) - 1)
        pose, root = motion.rotations[f], motion.root[f]
        positions, _ = forward(motion.skeleton, pose, root)
        yaw = float(heading(motion.skeleton, pose, root))
        home = quat.about("Y", -yaw)
        origin = np.array([root[0], 0.0, root[2]])
        places = [quat.rotate(home, positions[joint] - origin) for joint in joints]
        g = min(f, len(motion) - 2)
        yaw = float(heading(motion.skeleton, motion.rotations[g], motion.root[g]))
        home = quat.about("Y", -yaw)
        step = quat.rotate(home, motion.root[g + 1] - motion.root[g])
        turn = quat.multiply(motion.rotations[g + 1, 0], quat.inverse(motion.rotations[g, 0]))
        return places, step, quat.rotate(home, 2 * quat.log(quat.shorter(turn)))

    here = at(frame)
    last, last_but_one = len(motion) - 2, len(motion) - 3
    p, q = at(min(frame, last)), at(min(frame, last) + 1)
    v, w = at(min(frame, last_but_one)), at(min(frame, last_but_one) + 1)
    columns = [*here[0], here[1], here[2]]
    rates = [b - a for a, b in zip(p[0], q[0], strict=True)] + [w[1] - v[1], w[2] - v[2]]
    return np.array(columns), np.array(rates)


def test_the_cost_is_that_of_a_plain_double_loop(bodies, graphs) -> None:
    collection = graphs.collection_of(bodies.wandering(40, 1), bodies.wandering(30, 2))
    metric = metric_of(collection)
    joints, weights = weighted_columns(collection.skeleton)
    features = [
        [plain_features(motion, joints, frame) for frame in range(len(motion))]
        for motion in collection.motions
    ]
    steps = [
        [[np.square(b[k] - a[k]).sum(axis=1) for k in (0, 1)] for a, b in pairwise(f)]
        for f in features
    ]
    largest = np.max([step for f in steps for step in f], axis=0)
    rows = [metric.rows(motion) for motion in collection.motions]
    rng = np.random.default_rng(0)
    for _ in range(40):
        s, t = rng.integers(0, 2, 2)
        i, j = rng.integers(0, len(rows[s])), rng.integers(0, len(rows[t]))
        (d, r), (e, q) = features[s][i], features[t][j]
        cost = 0.0
        most = np.maximum(largest, SMALLEST)
        for column, weight in enumerate(weights):
            cost += weight * np.square(d[column] - e[column]).sum() / most[0][column]
            cost += RATES * weight * np.square(r[column] - q[column]).sum() / most[1][column]
        assert cut_costs(rows[s][i : i + 1], rows[t][j : j + 1])[0, 0] == pytest.approx(cost, 1e-9)


def test_it_does_not_depend_on_where_a_clip_lies_and_is_zero_for_a_frame_with_itself(
    bodies, graphs
) -> None:
    a, b = bodies.wandering(40, 1), bodies.wandering(40, 2)
    here = graphs.collection_of(a, b)
    there = graphs.collection_of(
        placed(a, 2.1, np.array([4.0, 0, -7])), placed(b, -0.7, np.array([-1.0, 0, 3]))
    )
    rows, moved = ([metric_of(c).rows(m) for m in c.motions] for c in (here, there))
    assert np.abs(cut_costs(*rows) - cut_costs(*moved)).max() < 1e-9 * cut_costs(*rows).max()
    assert np.abs(np.diag(cut_costs(rows[0], rows[0]))).max() < 1e-9
    assert np.abs(cut_costs(rows[0], rows[1]) - cut_costs(rows[1], rows[0]).T).max() < 1e-9


def test_o_and_l_are_the_largest_steps_anywhere(bodies, graphs) -> None:
    still = bodies.standing(6)
    root = still.root.copy()
    root[:, 2] = [0.0, 0.1, 0.3, 0.6, 0.6, 0.6]  # steps .1 .2 .3 0 0, changes .1 .1 −.3 0
    collection = graphs.collection_of(still, type(still)(still.skeleton, still.rotations, root))
    joints, _ = weighted_columns(collection.skeleton)
    most, most_rate = largest_steps(collection, joints)
    velocity, turning = len(joints), len(joints) + 1
    assert most[velocity] == pytest.approx(0.3**2)
    assert most_rate[velocity] == pytest.approx(0.4**2)  # from .1 to −.3
    assert np.delete(most, velocity) == pytest.approx(0.0, abs=1e-20)
    assert most[turning] == 0.0
    features, rates = torso_features(collection.motions[1], list(joints))
    assert features.shape == rates.shape == (6, len(joints) + 2, 3)


def test_edges_are_all_the_cells_under_the_threshold(bodies, graphs) -> None:
    collection = graphs.collection_of(*(bodies.wandering(40, seed) for seed in range(3)))
    costs = graphs.all_costs(collection)
    tau = float(np.quantile(costs[np.isfinite(costs)], 0.1))
    space = cut_space(collection, tau)
    found = np.full(costs.shape, np.inf)
    for clip in range(3):
        edges = space.edges_from(clip)
        i = collection.starts[clip] + edges.from_frame
        j = collection.starts[edges.to_clip] + edges.to_frame
        found[i, j] = edges.cost
    assert np.array_equal(np.isfinite(found), costs < tau)
    there = np.isfinite(found)
    assert np.abs(found[there] - costs[there]).max() < 1e-9 * tau
