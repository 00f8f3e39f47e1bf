"""Motion graphs: costs of all pairs, building, loading, and the search beside what people use.

On the 69 clips of ACCAD's performer where they lie beside the checkout; there are no rows without.
"""

import os
import pickle
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from stimuli.collection import Collection, collected
from stimuli.graph import (
    Demands,
    MotionGraph,
    begin_search,
    build_graph,
    read_demands,
    read_graph,
    search_space,
    write_graph,
)
from stimuli.graph.edges import ROWS, cut_space
from stimuli.graph.score_loop import MOST_NODES, Space, new_trace
from stimuli.motion import Library
from tests.benchmarks.rows import row
from tests.conftest import SHARED

DEMANDED = 30
MUTATIONS = 300_000
LONG, LONG_ONES = 60.0, 6  # seconds that a search is compared with, and of how many demands
Peak = Callable[[], float]


def rows() -> list[dict[str, Any]]:
    """Ratios to the matrix product, to NumPy, to random walks and to a minute's search."""
    folder = SHARED / "accad_male1_bvh"
    if not folder.is_dir():
        return []
    collection = collected(Library([folder]))
    product = _product(collection)
    build = _seconds(lambda: build_graph(collection, 1.0), 1)
    graph = build_graph(collection, 1.0)
    name = f"motion graph of {int(collection.starts[-1])} frames, {len(graph.cuts):,} edges"
    return [
        row("all pairs' costs in blocks, those under a threshold picked", _pairs(collection), "s",
            "the product", product, faster=0.5),
        row(f"{name}: build", build, "s", "60 × the product", 60 * product, faster=1.0),
        row(f"{name}: load", _loading(graph), "s", "build", build, faster=20.0),
        *_search(collection, graph),
    ]  # fmt: skip


def _seconds(work: Callable[[], object], runs: int = 3) -> float:
    work()
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def _product(collection: Collection) -> float:
    """Seconds of the bare product in single precision of the same shape."""
    table = cut_space(collection, 1.0).rows.astype(np.float32)
    return _seconds(lambda: table @ table.T)


def _pairs(collection: Collection) -> float:
    """Seconds for the costs of all pairs, block by block, and to pick those near the threshold."""
    space = cut_space(collection, 1.0)
    frames = len(space.rows)
    return _seconds(lambda: [space.near(n, min(n + ROWS, frames)) for n in range(0, frames, ROWS)])


def _loading(graph: MotionGraph) -> float:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "graph.npz"
        write_graph(graph, path)
        return _seconds(lambda: read_graph(path), 5)


def demanded(seed: int) -> Demands:
    """A start, an end and two places between, in 300 frames: strides of half to four metres, each
    turned by up to a right angle from the one before."""
    rng = np.random.default_rng([2002, seed])
    heading, x, z = rng.uniform(0, 360), 0.0, 0.0
    bodies = [f"{{ at = 0, place = [0, 0], heading = {heading} }}"]
    for at in (100, 200, 299):
        heading += rng.uniform(-90, 90)
        far = rng.uniform(0.5, 4)
        x, z = x + far * np.sin(np.radians(heading)), z + far * np.cos(np.radians(heading))
        bodies.append(f"{{ at = {at}, place = [{x}, {z}], heading = {heading} }}")
    with TemporaryDirectory() as folder:
        path = Path(folder) / "demands.toml"
        path.write_text(f"frames = 300\nbody = [{', '.join(bodies)}]\n", encoding="utf-8")
        return read_demands(path).figures[0]


def _search(collection: Collection, graph: MotionGraph) -> list[dict[str, Any]]:
    """Scores of a second, of random walks of a second, of a minute; the first path; the speed."""
    space = search_space(graph, collection)
    warm = begin_search(demanded(0), graph, collection, space, 0)
    warm.go(mutations=50_000)
    _walked(demanded(0), graph, collection, space, 0.1)
    ours, walks, longer, firsts = [], [], [], []
    for seed in range(DEMANDED):
        demands = demanded(seed)
        found = begin_search(demands, graph, collection, space, seed)
        firsts.append(_first(demands, graph, collection, space, seed))
        found.go(seconds=1.0)
        ours.append(found.best)
        walks.append(_walked(demands, graph, collection, space, 1.0))
        if seed < LONG_ONES:
            found.go(seconds=LONG - 1.0)
            longer.append(found.best)
    speed, plain = _speed(warm), _plain_speed(warm)
    name = f"search, median score of {DEMANDED} demands after a second"
    return [
        row(name, statistics.median(ours), "S", "random walks, a second",
            statistics.median(walks), faster=3.0),
        row(f"the same, of the first {LONG_ONES}", statistics.median(ours[:LONG_ONES]), "S",
            "a minute", statistics.median(longer), faster=1 / 1.3),
        row("search, the first whole path", statistics.median(firsts), "s", felt=0.1),
        row("search, a mutation", 1e6 / speed, "µs", "the same lines in plain NumPy", 1e6 / plain,
            faster=20.0),
    ]  # fmt: skip


def _first(
    demands: Demands, graph: MotionGraph, collection: Collection, space: Space, seed: int
) -> float:
    """Seconds from nothing to a path of the whole length."""
    start = time.perf_counter()
    found = begin_search(demands, graph, collection, space, seed)
    while not np.isfinite(found.best):
        found.go(mutations=200)
    return time.perf_counter() - start


def _walked(
    demands: Demands, graph: MotionGraph, collection: Collection, space: Space, seconds: float
) -> float:
    """The best score of compiled random walks of G, on both cores: fairmotion's way."""
    from concurrent.futures import ThreadPoolExecutor

    from stimuli.graph.walk_loop import best_walk

    search = begin_search(demands, graph, collection, space, 0)
    end = time.perf_counter() + seconds

    def walk(seed: int) -> float:
        state = np.random.SeedSequence([seed]).generate_state(1, np.uint64) | np.uint64(1)
        path, trace, least = np.zeros(MOST_NODES, dtype=np.int32), new_trace(search.aim), np.inf
        while time.perf_counter() < end:
            score, _ = best_walk(space, search.aim, state, 1000, True, path, trace)
            least = min(least, score)
        return float(least)

    with ThreadPoolExecutor(2) as pool:
        return min(pool.map(walk, range(2)))


def _speed(search: Any) -> float:
    """Random mutations a second that one core tries and scores, compiled."""
    climb, given = _climbing(search)
    climb(*given, 1000)
    start = time.thread_time()
    climb(*given, MUTATIONS)
    return MUTATIONS / (time.thread_time() - start)


def _plain_speed(search: Any) -> float:
    """The same loop in plain NumPy: the same lines with the compiler off, in a process of its own.

    It is given the graph, the demands and the path, so that only the loop is timed.
    """
    with TemporaryDirectory() as folder:
        path = Path(folder) / "given.pickle"
        crew = search.crews[0]
        state = (tuple(search.space), tuple(search.aim), crew.random, crew.kept[0].path)
        path.write_bytes(pickle.dumps(state))
        told = subprocess.run(
            [sys.executable, "-m", "tests.benchmarks.plain_climb", str(path)],
            env={**os.environ, "NUMBA_DISABLE_JIT": "1"}, check=True, text=True,
            stdout=subprocess.PIPE,
        )  # fmt: skip
    return float(told.stdout)


def _climbing(search: Any) -> tuple[Callable[..., Any], tuple[Any, ...]]:
    """The loop and what it is given but for how many mutations: an answer, and endless patience."""
    from stimuli.graph.search_loop import climb

    aim, crew = search.aim, search.crews[0]
    aim = aim._replace(effort=np.array([1, 1, 1 << 30, 0], np.int32))
    path = np.zeros(MOST_NODES, np.int32)
    path[: len(crew.kept[0].path)] = crew.kept[0].path
    traces = new_trace(aim), new_trace(aim)

    def run(space: Space, most: int) -> None:
        climb(space, aim, crew.random.copy(), path, len(crew.kept[0].path), crew.kept[0].score,
              most, *traces)  # fmt: skip

    return run, (search.space,)
