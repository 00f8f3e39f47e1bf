"""Transition points of a study that compares ways through a graph with blends, drawn by a seed."""

import numpy as np

from stimuli.collection import Collection
from stimuli.errors import InputError
from stimuli.graph.graph import MotionGraph
from stimuli.graph.shortest import shortest_way
from stimuli.motion.skeleton import Motion
from stimuli.transition.draw import away_from_fixed, draw_point

SHORTEST_WAY, LONGEST_WAY = 15, 90  # frames: half a second, three seconds
DRAWS = 400


def draw_pair(
    a: Motion, b: Motion, ends: tuple[int, int], graph: MotionGraph, collection: Collection,
    generator: np.random.Generator,
) -> tuple[int, int]:  # fmt: skip
    """Frames (i, j) of two clips (`ends`, in the collection; `a` and `b` as their files have them).

    Drawn as for study one, until the graph's shortest way lasts half a second to three seconds.
    InputError when no draw of 400 does.
    """
    for _ in range(DRAWS):
        i, j = draw_point(a, b, away_from_fixed, generator)
        try:
            way = shortest_way(graph, (ends[0], i), (ends[1], j))
        except InputError:
            continue
        if SHORTEST_WAY <= sum(map(len, way)) - 1 <= LONGEST_WAY:
            return i, j
    names = " and ".join(collection.names[end] for end in ends)
    raise InputError(
        f"{names}: expected frames with a way of {SHORTEST_WAY} to {LONGEST_WAY} frames between "
        f"them, found none in {DRAWS} draws.\nTake other clips, or a larger --tau."
    )
