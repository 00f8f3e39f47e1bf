"""Ways through a collection, for the methods of a set that go from one motion to another by others.

A graph is found in the user's cache, or built and kept there: the same clips give the same graph.
"""

from functools import lru_cache

from stimuli.collection import Collection, collected
from stimuli.errors import InputError
from stimuli.graph import MotionGraph, graph_kept, route_of
from stimuli.motion.library import Library
from stimuli.sets.spec import Pairing, SetSpec, Through
from stimuli.transition import METHODS, Route


def way_of(spec: SetSpec, pairing: Pairing, library: Library, method: str) -> Route | None:
    """The shortest way of a pairing, for a method that goes through other motions; else None.

    InputError where the set names no collection, and where no way leads there.
    """
    if method not in METHODS or not METHODS[method].through:
        return None
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
