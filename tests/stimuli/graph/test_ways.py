"""The shortest way, the motion that is put together, and motion-graph as a method of the table."""

from types import MappingProxyType

import numpy as np
import pytest
from scipy.sparse import lil_array
from scipy.sparse.csgraph import dijkstra

from stimuli.errors import InputError
from stimuli.graph import Stretch, assembled, motion_plan, route_of, shortest_way, way_motion
from stimuli.graph.assemble import CUTTINGS
from stimuli.graph.demands import Demand, Demands
from stimuli.graph.shortest import A_CUT
from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import forward, headings
from stimuli.transition import METHODS, transition
from stimuli.transition.smooth import smoothed_cut, smoothing


def test_the_shortest_way_is_scipys_on_the_plain_graph(graphs) -> None:
    for seed in range(3):
        collection, graph = graphs.toy(seed, edges=150)
        starts = collection.starts
        plain = lil_array((starts[-1], starts[-1]))
        for clip in range(len(collection)):
            for g in range(starts[clip], starts[clip + 1] - 1):
                plain[g, g + 1] = 1.0
        for s, i, t, j, cost in zip(*graph.cuts, strict=True):
            if j + 1 < graph.frames[t]:
                plain[starts[s] + i, starts[t] + j + 1] = 1.0 + A_CUT * cost
        far = dijkstra(plain.tocsr())
        rng, found = np.random.default_rng(seed), 0
        for _ in range(60):
            (s, t), (i, j) = rng.integers(0, 4, 2).tolist(), rng.integers(0, 30, 2).tolist()
            expected = far[starts[s] + i, starts[t] + j]
            if (s, i) == (t, j):
                continue
            if np.isinf(expected):
                with pytest.raises(InputError, match="expected a way at tau"):
                    shortest_way(graph, (s, i), (t, j))
                continue
            way = shortest_way(graph, (s, i), (t, j))
            length = sum(map(len, way)) - 1
            assert length + A_CUT * sum(p.cost for p in way[1:]) == pytest.approx(expected)
            assert (way[0].clip, way[0].first) == (s, i)
            assert (way[-1].clip, way[-1].last) == (t, j)
            found += 1
        assert found > 10


def test_the_smoothing_function_is_the_papers() -> None:
    """4.2.3: 0, ½((f − d + s)/s)², −½(·)² + 2(·) − 2, 0, for s = 30."""
    s = 30
    rise, fall = smoothing(s, s)
    f = np.arange(-s + 1, s + 1)
    u = (f + s) / s
    assert rise == pytest.approx(0.5 * u[:s] ** 2)
    assert fall == pytest.approx(-0.5 * u[s:] ** 2 + 2 * u[s:] - 2)
    assert (rise[-1], fall[-1]) == (0.5, 0.0)
    short, long = smoothing(10, 30)
    assert short[-1] == pytest.approx(0.25)
    assert np.all(np.diff(long) > 0)


def test_a_smoothed_cut_is_continuous_and_leaves_what_is_far(bodies) -> None:
    a, b = bodies.wandering(120, 1), bodies.wandering(120, 2)
    for motion in (smoothed_cut(a, b, 60, 50), smoothed_cut(a, b, 60, 50, keep=45),
                   smoothed_cut(a, b, 10, 112)):  # fmt: skip
        assert np.allclose(np.linalg.norm(motion.rotations, axis=-1), 1.0)
    motion = smoothed_cut(a, b, 60, 50)
    assert np.array_equal(motion.rotations[:31], a.rotations[:31])
    assert np.allclose(motion.rotations[91:, 1:], b.rotations[81:, 1:])
    steps = quat.geodesic(motion.rotations[1:], motion.rotations[:-1]).max(axis=1)
    assert steps[55:65].max() < 1.5 * np.delete(steps, np.s_[25:95]).max()


def walked(bodies, graphs):
    collection = graphs.collection_of(*(bodies.wandering(120, n, speed=0.1) for n in range(3)))
    body = [
        Demand("body", MappingProxyType(
            {"at": at, "place": place, "heading": angle, "weight": 1.0}), ("body", n))
        for n, (at, place, angle) in enumerate(
            ((0, [1, 2], 30), (60, [1.5, 3], 10), (149, [2, 5], -60)))
    ]  # fmt: skip
    demands = Demands("", 150, tuple(body))
    pieces = (Stretch(0, 5, 50), Stretch(1, 30, 75, 0.4), Stretch(2, 20, 77, 0.7))
    return collection, motion_plan(demands, pieces, collection)


@pytest.mark.parametrize("joining", list(CUTTINGS))
def test_every_body_demand_is_met_but_by_bare_cuts(bodies, graphs, joining: str) -> None:
    collection, plan = walked(bodies, graphs)
    motion = assembled(plan, collection, joining)
    assert len(motion) == 150
    for body in plan.demands.of("body"):
        at = body["at"]
        angle = np.degrees(headings(motion)[at]) - body["heading"]
        away = np.hypot(*(motion.root[at, [0, 2]] - body["place"]))
        if joining != "cut" or at == 0:
            assert away < 1e-3
            assert abs((angle + 180) % 360 - 180) < 0.1
    if joining == "cut":
        assert motion.root[:, [0, 2]] == pytest.approx(plan.place, abs=1e-9)
        apart = headings(motion) - plan.yaw
        assert np.abs((apart + np.pi) % (2 * np.pi) - np.pi).max() < 1e-9


def test_a_way_goes_through_its_frames(bodies, graphs) -> None:
    collection, graph = graphs.toy(1, edges=150)
    way = next(
        way for way in (shortest_way(graph, (0, 2), (t, j)) for t in (1, 2) for j in (20, 25))
        if len(way) > 1
    )  # fmt: skip
    motion = way_motion(way, collection)
    assert len(motion) == sum(map(len, way))


def test_motion_graph_leaves_a_at_i_and_reaches_b_at_j(bodies, graphs) -> None:
    collection = graphs.collection_of(*(bodies.wandering(120, n, speed=0.1) for n in range(3)))
    graph = graphs.with_edges(collection, 4000)
    a, b = collection.motions[0], collection.motions[1]
    route = route_of(graph, collection, (0, 40), (1, 70))
    done = transition(a, b, 40, 70, method="motion-graph", route=route)
    assert done.frames == route.frames
    assert np.array_equal(done.motion.rotations[:41], a.rotations[:41])
    assert len(done.motion) == 41 + route.frames + len(b) - 71
    last = done.mixed[1]
    tail = len(done.motion) - last - 1
    assert np.allclose(done.motion.rotations[last + 1 :, 1:], b.rotations[len(b) - tail :, 1:])
    assert [p["clip"] for p in done.report["pieces"]][-1] == "b"
    assert done.report["pieces"][-1]["to_frame"] == 70
    positions, _ = forward(done.motion.skeleton, done.motion.rotations, done.motion.root)
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=-1).max(axis=1)
    assert steps[38 : last + 2].max() < 3 * max(steps[:38].max(), steps[last + 2 :].max())


def test_motion_graph_without_a_collection_says_so(bodies) -> None:
    a, b = bodies.wandering(90, 1), bodies.wandering(90, 2)
    assert METHODS["motion-graph"].through
    with pytest.raises(InputError, match="expected a collection of clips"):
        transition(a, b, 40, 40, method="motion-graph")
    with pytest.raises(InputError, match="expected no length"):
        transition(a, b, 40, 40, method="motion-graph", frames=10)


def test_both_frames_at_one_instant_leave_no_way(bodies, graphs) -> None:
    collection, graph = graphs.toy(1, edges=150)
    route = route_of(graph, collection, (0, 2), (0, 20))
    a = collection.motions[0]
    with pytest.raises(InputError, match="expected the specification start-end"):
        transition(a, a, 2, 20, method="motion-graph", specification="center-aligned", route=route)
