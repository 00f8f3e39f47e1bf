"""Ways through a collection or an embedding, for the methods of a set whose way is found before.

A graph is found in the user's cache, or built and kept there: the same clips give the same graph.
"""

from collections.abc import Callable, Mapping
from functools import lru_cache

from stimuli.collection import Collection, collected
from stimuli.errors import InputError
from stimuli.graph import MotionGraph, graph_kept, route_of
from stimuli.manifold import passing
from stimuli.motion.library import Library
from stimuli.sets.spec import Pairing, SetSpec, Through
from stimuli.transition import METHODS, Route


def way_of(spec: SetSpec, pairing: Pairing, library: Library, method: str) -> Route | None:
    """The way of a pairing, for a method that goes through something; else None.

    InputError where the set names no collection that is needed, and where no way leads there.
    """
    if method not in METHODS or not METHODS[method].through:
        return None
    return _WAYS[METHODS[method].through](spec, pairing, library, method)


def _by_graph(spec: SetSpec, pairing: Pairing, library: Library, method: str) -> Route:
    """The shortest way through the clips that the set names."""
    if spec.through is None:
        raise InputError(
            f"set {spec.name}: {method} needs a collection of clips, found none.\n"
            'Give each set a table [sets.NAME.collection], such as clips = ["Male1_*"].'
        )
    collection, graph = graph_through(library, spec.through)
    ends = [
        (collection.place(library.find(clip).stem), frame)
        for clip, frame in (
            (pairing.from_clip, pairing.from_frame), (pairing.to_clip, pairing.to_frame)
        )
    ]  # fmt: skip
    return route_of(graph, collection, *ends)


@lru_cache(maxsize=4)
def graph_through(library: Library, through: Through) -> tuple[Collection, MotionGraph]:
    """The collection of a library that is meant, and its graph."""
    collection = collected(library, through.clips)
    return collection, graph_kept(collection, through.tau)


def _by_embedding(spec: SetSpec, pairing: Pairing, library: Library, method: str) -> Route:
    """The straight way through the embedding of the two clips."""
    return _passing(library, pairing)


@lru_cache(maxsize=64)
def _passing(library: Library, pairing: Pairing) -> Route:
    """The same way, trained for once: a set is planned, then laid out."""
    a, b = (library.load(name) for name in (pairing.from_clip, pairing.to_clip))
    ends = pairing.from_frame, pairing.to_frame
    return passing(a.motion, b.motion, *ends, (a.name, b.name))


_WAYS: Mapping[str, Callable[[SetSpec, Pairing, Library, str], Route]] = {
    "collection": _by_graph,
    "embedding": _by_embedding,
}
