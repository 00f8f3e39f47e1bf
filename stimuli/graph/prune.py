"""A graph and its collection without the clips outside the largest strongly connected part.

Motions of what is left never come where nothing leads on but at the ends of clips.
"""

from dataclasses import replace

import numpy as np

from stimuli.collection import Collection
from stimuli.graph.arrays import Indices
from stimuli.graph.graph import MotionGraph


def largest_part(collection: Collection, graph: MotionGraph) -> tuple[Collection, MotionGraph]:
    """The clips of the largest strongly connected part, and the edges between them."""
    kept = np.flatnonzero(graph.parts == 0)
    clips = replace(
        collection,
        names=tuple(collection.names[n] for n in kept),
        motions=tuple(collection.motions[n] for n in kept),
        spans=tuple(collection.spans[n] for n in kept),
    )
    whole = np.isin(graph.root_from, kept) & np.isin(graph.root_to, kept)
    sizes = np.diff(np.append(graph.roots, len(graph.right)))
    stays = np.repeat(whole, sizes)
    place = np.cumsum(stays) - 1  # of each node among those that stay

    def moved(nodes: Indices) -> Indices:
        return place[nodes].astype(np.int32)

    right = graph.right[stays]
    return clips, MotionGraph(
        names=clips.names,
        frames=graph.frames[kept],
        tau=graph.tau,
        collection=clips.hash,
        labels=graph.labels[stays],
        right=np.where(right > 0, moved(right), 0).astype(np.int32),
        leaf=moved(graph.leaf[stays]),
        roots=moved(graph.roots[whole]),
        root_from=np.searchsorted(kept, graph.root_from[whole]).astype(np.int32),
        root_to=np.searchsorted(kept, graph.root_to[whole]).astype(np.int32),
    )
