"""What tests of motion graphs share: small collections whose graphs can be gone through whole."""

from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import pytest

from stimuli.collection import Collection
from stimuli.graph import MotionGraph, build_graph
from stimuli.graph.cost import cut_costs, metric_of
from stimuli.motion import Library, Motion, user_library
from tests.conftest import ABSENT, SHARED

APART = 15


def collection_of(*motions: Motion, labels: tuple[str, ...] = ()) -> Collection:
    """Motions of one body as a collection of clips called a, b, c …"""
    from stimuli.collection.annotations import Span

    names = tuple("abcdefghij"[: len(motions)])
    spans = tuple(
        (Span(0, len(motion) - 1, labels[n]),) if labels else () for n, motion in enumerate(motions)
    )
    return Collection(names, motions, spans)


def all_costs(collection: Collection) -> np.ndarray:
    """The cost between every two frames, infinite where no edge may be."""
    metric = metric_of(collection)
    rows = np.concatenate([metric.rows(motion) for motion in collection.motions])
    costs = cut_costs(rows, rows)
    clip = np.repeat(np.arange(len(collection)), np.diff(collection.starts))
    frame = np.arange(len(clip)) - collection.starts[clip]
    near = np.abs(frame[:, None] - frame) <= APART
    costs[(clip[:, None] == clip) & near] = np.inf
    return costs


def with_edges(collection: Collection, count: int) -> MotionGraph:
    """The graph whose threshold leaves so many edges."""
    costs = np.sort(all_costs(collection).ravel())
    tau = float((costs[count - 1] + costs[count]) / 2)
    graph = build_graph(collection, tau)
    assert len(graph.cuts) == count
    return graph


@pytest.fixture(scope="session")
def graphs(bodies) -> SimpleNamespace:
    """The functions above, and `toy(seed)`: four clips of thirty frames, thirty edges."""

    def toy(seed: int, clips: int = 4, frames: int = 30, edges: int = 30):
        collection = collection_of(
            *(bodies.wandering(frames, 10 * seed + n, speed=0.2) for n in range(clips))
        )
        return collection, with_edges(collection, edges)

    return SimpleNamespace(collection_of=collection_of, all_costs=all_costs,
                           with_edges=with_edges, toy=toy)  # fmt: skip


@pytest.fixture(scope="session")
def walks(sample_motions) -> tuple[Collection, MotionGraph]:
    """The walks and turns of the sample motions, and their graph at a threshold of 2."""
    from stimuli.collection import collected

    collection = collected(Library([user_library()]), ("0walk*", "humanoid3d_walk", "turn*"))
    return collection, build_graph(collection, 8.0)


@pytest.fixture(scope="session")
def accad() -> Callable[[float], tuple[Collection, MotionGraph]]:
    """The walking clips of ACCAD's performer at a threshold; skipped where they are not."""
    if not SHARED.is_dir():
        pytest.skip(ABSENT)
    from stimuli.collection import collected

    collection = collected(Library([SHARED / "accad_male1_bvh"]), ("Male1_B*",))
    return lambda tau: (collection, build_graph(collection, tau))
