"""Building a motion graph, a clip's edges and their trees at a time, here or on a cluster."""

import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from stimuli.collection import Collection
from stimuli.errors import InputError
from stimuli.graph.arrays import Indices
from stimuli.graph.edges import CutSpace, cut_space
from stimuli.graph.graph import MotionGraph

TAU = 1.0
AN_EDGE = 200  # bytes of memory for each edge while a graph is built and written
HELD_BACK = 100  # megabytes

# calls a function of (item, shared) on all items, results in order, and ships `shared` but once
Mapped = Callable[[Callable[[int, Any], "Branch"], Any, Sequence[int]], Iterable["Branch"]]


@dataclass(frozen=True, eq=False)
class Branch:
    """The trees of all edges that leave one clip; nodes are counted from 0."""

    clip: int
    labels: npt.NDArray[np.float32]
    right: Indices
    leaf: Indices
    roots: Indices
    root_to: Indices


def build_graph(
    collection: Collection,
    tau: float = TAU,
    *,
    mapped: Mapped | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> MotionGraph:
    """The motion graph of a collection: edges wherever the cost is below `tau`, in a hierarchy.

    `mapped` runs the work for each clip, on all cores unless given; the graph is the same whatever
    it does. InputError where no two frames are so near, or so many that memory does not hold them.
    """
    space = cut_space(collection, tau)
    most = free_memory() // AN_EDGE
    branches, edges = [], 0
    with _threads() if mapped is None else _given(mapped) as run:
        for done, found in enumerate(run(branch, space, range(len(collection))), start=1):
            branches.append(found)
            edges += (len(found.right) + len(found.roots)) // 2
            if edges > most:
                raise _too_many(tau, edges, most, done, len(collection))
            if progress:
                progress(done, len(collection))
    if not edges:
        raise _none(collection, space)
    return _joined(collection, tau, branches)


def branch(clip: int, space: CutSpace) -> Branch:
    """The edges that leave a clip, and their trees."""
    from stimuli.graph.summary_loop import forest

    edges = space.edges_from(clip)
    first = np.ones(len(edges.cost), dtype=bool)
    first[1:] = np.diff(edges.to_clip) != 0
    begins = np.flatnonzero(first)
    labels, right, leaf, roots, of_pair = forest(
        edges.from_frame.astype(np.int64),
        edges.to_frame.astype(np.int64),
        edges.cost,
        np.append(begins, len(first)),
    )
    return Branch(
        clip,
        labels.astype(np.float32),
        right.astype(np.int32),
        leaf.astype(np.int32),
        roots.astype(np.int32),
        edges.to_clip[begins][of_pair],
    )


def _joined(collection: Collection, tau: float, branches: list[Branch]) -> MotionGraph:
    base = np.cumsum([0, *(len(b.right) for b in branches)]).astype(np.int32)

    def shifted(name: str) -> Indices:
        each = [getattr(b, name) + n for b, n in zip(branches, base, strict=False)]
        return np.concatenate(each).astype(np.int32)

    right = np.concatenate([b.right for b in branches])
    right = np.where(right > 0, shifted("right"), 0).astype(np.int32)
    return MotionGraph(
        names=collection.names,
        frames=np.diff(collection.starts).astype(np.int32),
        tau=float(tau),
        collection=collection.hash,
        labels=np.concatenate([b.labels for b in branches]),
        right=right,
        leaf=shifted("leaf"),
        roots=shifted("roots"),
        root_from=np.repeat([b.clip for b in branches], [len(b.roots) for b in branches]).astype(
            np.int32
        ),
        root_to=np.concatenate([b.root_to for b in branches]).astype(np.int32),
    )


@contextmanager
def _threads() -> Iterator[Mapped]:
    """All cores of this machine; the loops and the product leave Python alone meanwhile."""
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:

        def run(function: Callable[[int, Any], Branch], shared: Any, items: Sequence[int]) -> (
            Iterable[Branch]
        ):  # fmt: skip
            return pool.map(lambda item: function(item, shared), items)

        try:
            yield run
        finally:
            pool.shutdown(cancel_futures=True)


@contextmanager
def _given(mapped: Mapped) -> Iterator[Mapped]:
    yield mapped


def free_memory() -> int:
    """Bytes that this process may still take: what the machine has free, and its own limit."""
    free = []
    with suppress(OSError, KeyError, ValueError):
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        told = dict(line.split(":") for line in lines)
        free.append(int(told["MemAvailable"].split()[0]) * 1024)
    if sys.platform != "win32":
        import resource

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
        with suppress(OSError, ValueError):
            pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
            if limit != resource.RLIM_INFINITY:
                free.append(limit - pages * resource.getpagesize())
    return max(min(free, default=4 << 30) - (HELD_BACK << 20), 0)


def _too_many(tau: float, edges: int, most: int, done: int, clips: int) -> InputError:
    return InputError(
        f"graph at tau {tau:g}: expected at most {most:,} edges, which free memory holds, found "
        f"{edges:,} in {done} of {clips} clips.\nTake a smaller --tau or fewer clips (--motions)."
    )


def _none(collection: Collection, space: CutSpace) -> InputError:
    clips = f"{len(collection)} clip{'s' * (len(collection) > 1)}"
    least = space.least()
    larger = f"a --tau above {least:.3g}" if np.isfinite(least) else "longer clips"
    return InputError(
        f"graph at tau {space.tau:g}: expected frames to cut between, found none in {clips} of "
        f"{int(collection.starts[-1])} frames.\n"
        f"Take {larger}, or more clips of the performer."
    )
