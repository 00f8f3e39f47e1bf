"""The hierarchy of 4.1: what its leaves, its labels and its levels are; files of it."""

import numpy as np
import pytest
from scipy import ndimage

from stimuli.errors import InputError
from stimuli.graph import build_graph, largest_part, read_graph, search_space, write_graph
from stimuli.graph.summary_loop import clusters_wanted, groups, k_means


@pytest.fixture(scope="module")
def made(bodies, graphs):
    collection = graphs.collection_of(*(bodies.wandering(80, n, speed=0.15) for n in range(4)))
    return collection, graphs.with_edges(collection, 1500)


def below(graph, node: int) -> list[int]:
    """The leaves below a node."""
    if graph.right[node] == 0:
        return [node]
    return below(graph, node + 1) + below(graph, int(graph.right[node]))


def test_its_leaves_are_exactly_the_edges_each_in_one_leaf(made, graphs) -> None:
    collection, graph = made
    costs = graphs.all_costs(collection)
    cuts = graph.cuts
    i, j = collection.starts[cuts.from_clip] + cuts.i, collection.starts[cuts.to_clip] + cuts.j
    assert len(set(zip(i.tolist(), j.tolist(), strict=True))) == len(cuts)
    assert np.array_equal(np.sort(i * 1000 + j), np.flatnonzero((costs < graph.tau).ravel())
                          // len(costs) * 1000 + np.flatnonzero((costs < graph.tau).ravel())
                          % len(costs))  # fmt: skip
    assert costs[i, j] == pytest.approx(cuts.cost, rel=1e-6)
    reached = [leaf for root in graph.roots for leaf in below(graph, int(root))]
    assert reached == graph.leaves.tolist()


def test_every_label_is_the_mean_of_the_leaves_below_and_stands_for_the_nearest(made) -> None:
    _, graph = made
    for node in range(len(graph.right)):
        leaves = graph.labels[below(graph, node)]
        assert graph.labels[node] == pytest.approx(leaves.mean(axis=0), abs=1e-3)
        away = np.square(leaves[:, :2] - graph.labels[node, :2]).sum(axis=1)
        chosen = graph.labels[graph.leaf[node], :2] - graph.labels[node, :2]
        assert np.square(chosen).sum() == pytest.approx(away.min(), abs=1e-2)
        assert graph.leaf[node] in below(graph, node)


def test_pairs_of_clips_joined_are_the_same_at_every_level(made) -> None:
    _, graph = made
    pairs = {(int(s), int(t)) for s, t in np.argwhere(graph.joined)}
    cuts = graph.cuts
    assert pairs == set(zip(cuts.from_clip.tolist(), cuts.to_clip.tolist(), strict=True))
    assert pairs == set(zip(graph.node_from.tolist(), graph.node_to.tolist(), strict=True))
    assert len(graph.roots) < len(cuts) / 2


def test_groups_are_those_of_eight_neighbours() -> None:
    rng = np.random.default_rng(0)
    for share in (0.1, 0.3, 0.5):
        cells = rng.random((40, 50)) < share
        x, y = np.nonzero(cells)
        labels, count = ndimage.label(cells, np.ones((3, 3)))
        found = groups(x, y)
        assert found.max() + 1 == count
        pairs = set(zip(labels[x, y].tolist(), found.tolist(), strict=True))
        assert len(pairs) == count


def test_a_group_falls_into_as_many_clusters_as_the_paper_says() -> None:
    """⌈√(major · minor)⌉ of a filled ellipse of 60 by 15 frames is 30; k-means fills them all."""
    x, y = np.nonzero(np.ones((80, 80)))
    inside = ((x - 40) / 30) ** 2 + ((y - 40) / 7.5) ** 2 <= 1
    x, y = x[inside], y[inside]
    points = np.arange(len(x))
    wanted = clusters_wanted(x, y, points)
    assert 29 <= wanted <= 31
    cluster = k_means(x, y, points, wanted)
    sizes = np.bincount(cluster, minlength=wanted)
    assert sizes.min() > 0
    assert sizes.max() < 4 * len(x) / wanted
    line = np.arange(30)
    assert clusters_wanted(line, line, line) == 7  # √(4σ · 1), σ the line's own deviation


def test_ends_of_clips_lead_nowhere(made) -> None:
    _, graph = made
    cuts = graph.cuts
    for clip, last in enumerate(graph.exits):
        on = (cuts.from_clip == clip) & (cuts.i > last)
        assert np.all(cuts.j[on] >= graph.exits[cuts.to_clip[on]])
        assert not graph.leads_on(clip, int(last) + 1)
        if last >= 0:
            assert graph.leads_on(clip, int(last))
            leaving = (cuts.from_clip == clip) & (cuts.i == last)
            assert np.any(cuts.j[leaving] < graph.exits[cuts.to_clip[leaving]])


def test_a_graph_comes_back_from_its_file_and_is_the_same_bytes_however_it_is_built(
    made, tmp_path
) -> None:
    collection, graph = made

    def in_turn(function, shared, items):
        return (function(item, shared) for item in items)

    again = build_graph(collection, graph.tau, mapped=in_turn)
    for name, one in (("one", graph), ("two", again)):
        write_graph(one, tmp_path / f"{name}.npz")
    assert (tmp_path / "one.npz").read_bytes() == (tmp_path / "two.npz").read_bytes()
    back = read_graph(tmp_path / "one.npz", collection)
    assert back.names == graph.names
    assert np.array_equal(back.labels, graph.labels)
    assert np.array_equal(back.right, graph.right)


def test_a_damaged_or_foreign_file_is_refused_in_words(made, bodies, graphs, tmp_path) -> None:
    _, graph = made
    path = tmp_path / "graph.npz"
    write_graph(graph, path)
    whole = path.read_bytes()
    other = graphs.collection_of(bodies.wandering(40, 9))
    with pytest.raises(InputError, match="one of other clips"):
        read_graph(path, other)
    for damaged in (whole[:-200], whole[: len(whole) // 2], b"PK\x03\x04", b"", b"hello"):
        path.write_bytes(damaged)
        with pytest.raises(InputError, match="damaged or foreign"):
            read_graph(path)
    flipped = bytearray(whole)
    flipped[len(whole) // 2] ^= 0xFF
    path.write_bytes(bytes(flipped))
    with pytest.raises(InputError, match="expected a graph of these clips"):
        read_graph(path)
    np.savez(path, head=np.zeros(3), frames=np.zeros(2))
    with pytest.raises(InputError, match="expected a graph of these clips"):
        read_graph(path)
    with pytest.raises(InputError, match="no such file"):
        read_graph(tmp_path / "none.npz")


def test_thresholds_that_leave_nothing_or_too_much_say_what_to_do(
    made, bodies, graphs, monkeypatch: pytest.MonkeyPatch
) -> None:
    collection, graph = made
    with pytest.raises(InputError, match="Take a --tau above ") as refused:
        build_graph(collection, 1e-9)
    least = float(str(refused.value).split("above ")[1].split(",")[0])
    assert least == pytest.approx(graph.cuts.cost.min(), rel=5e-3)
    short = graphs.collection_of(bodies.wandering(12, 1))
    with pytest.raises(InputError, match="Take longer clips"):
        build_graph(short, 1.0)
    monkeypatch.setattr("stimuli.graph.build.free_memory", lambda: 100_000)
    with pytest.raises(InputError, match="at most 500 edges, which free memory holds"):
        build_graph(collection, graph.tau)


def test_a_graph_of_the_largest_connected_part_has_its_clips_and_their_edges(
    bodies, graphs
) -> None:
    few = graphs.collection_of(*(bodies.wandering(60, n, speed=0.15) for n in range(6)))
    graph = graphs.with_edges(few, 40)
    inside = {graph.names[n] for n in np.flatnonzero(graph.parts == 0)}
    assert 1 < len(inside) < 6
    collection, part = largest_part(few, graph)
    assert set(collection.names) == set(part.names) == inside
    assert part.collection == collection.hash
    assert not part.parts.any()

    def told(graph) -> list[tuple]:
        edges = zip(*(column.tolist() for column in graph.cuts), strict=True)
        return [(graph.names[s], i, graph.names[t], j, cost) for s, i, t, j, cost in edges]

    assert told(part) == [e for e in told(graph) if {e[0], e[2]} <= inside]
    for node in range(len(part.right)):
        assert part.labels[node] == pytest.approx(part.labels[below(part, node)].mean(axis=0))
    search_space(part, collection)
