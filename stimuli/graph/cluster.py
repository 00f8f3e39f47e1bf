"""Building a graph on a Dask cluster: a clip's edges are one job, the collection is sent once."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from stimuli.cluster import cluster
from stimuli.graph.build import Branch, Mapped


@contextmanager
def on_scheduler(address: str) -> Iterator[Mapped]:
    """A map over the workers of a Dask scheduler, for `build_graph`; for errors see `cluster`."""
    with cluster(address) as workers:

        def run(
            function: Callable[[int, Any], Branch], shared: Any, items: Sequence[int]
        ) -> Iterator[Branch]:
            done: dict[int, Branch] = {}
            following = 0
            for place, found in workers.spread(function, items, shared):
                done[place] = found
                while following in done:
                    yield done.pop(following)
                    following += 1

        yield run
