"""The shortest way from one frame to another, in frames: exact, by SciPy on the plain graph.

Each frame is a node. It is followed by the next one of its clip, and across an edge s_i → t_j by
the frame after t_j: a cut takes a frame's time like any step. Cuts are counted in frames: one of
cost 1 as thirty more, the second over which it is smoothed on either side. If they were free, the
shortest way would be cut at every frame, which is no motion any more.
"""

from functools import lru_cache
from typing import Any

import numpy as np

from stimuli.errors import InputError
from stimuli.graph.graph import MotionGraph
from stimuli.graph.plan import Stretch

A_CUT = 30.0  # frames that a cut of cost 1 counts as, beside the one that it takes


@lru_cache(maxsize=2)
def plain_graph(graph: MotionGraph) -> Any:
    """The plain graph as a sparse matrix (F, F): 1 for each step, more for a cut."""
    from scipy.sparse import csr_array

    starts = np.concatenate([[0], np.cumsum(graph.frames)])
    frames = int(starts[-1])
    on = np.setdiff1d(np.arange(frames), starts[1:] - 1)
    cuts = graph.cuts
    last = cuts.j + 1 >= graph.frames[cuts.to_clip]
    i = starts[cuts.from_clip] + cuts.i
    j = starts[cuts.to_clip] + cuts.j + 1
    apart = ~last & (j != i + 1)  # an edge that leads on as the clip does anyway
    rows = np.concatenate([on, i[apart]])
    columns = np.concatenate([on + 1, j[apart]])
    steps = np.concatenate([np.ones(len(on)), 1.0 + A_CUT * cuts.cost[apart]])
    return csr_array((steps, (rows, columns)), shape=(frames, frames))


def shortest_way(
    graph: MotionGraph, start: tuple[int, int], end: tuple[int, int]
) -> tuple[Stretch, ...]:
    """The pieces played from a frame (clip, frame) to another, both included.

    InputError where no way leads there, or where they are one.
    """
    from scipy.sparse.csgraph import dijkstra

    if start == end:
        raise InputError("path: expected two frames, found one twice.")
    starts = np.concatenate([[0], np.cumsum(graph.frames)])
    source, target = (int(starts[clip] + frame) for clip, frame in (start, end))
    matrix = plain_graph(graph)
    _, before = dijkstra(matrix, indices=source, return_predecessors=True)
    if before[target] < 0:
        raise _no_way(graph, start, end)
    way = [target]
    while way[-1] != source:
        way.append(int(before[way[-1]]))
    return _pieces(way[::-1], starts, matrix)


def _pieces(way: list[int], starts: np.ndarray, matrix: Any) -> tuple[Stretch, ...]:
    clips = np.searchsorted(starts, way, side="right") - 1
    local = np.array(way) - starts[clips]
    breaks = [
        n for n in range(1, len(way)) if clips[n] != clips[n - 1] or local[n] != local[n - 1] + 1
    ]
    pieces = []
    for first, stop in zip([0, *breaks], [*breaks, len(way)], strict=True):
        cost = (float(matrix[way[first - 1], way[first]]) - 1.0) / A_CUT if first else 0.0
        pieces.append(
            Stretch(int(clips[first]), int(local[first]), int(local[stop - 1]), round(cost, 6))
        )
    return tuple(pieces)


def _no_way(graph: MotionGraph, start: tuple[int, int], end: tuple[int, int]) -> InputError:
    here, there = (f"{graph.names[clip]}:{frame}" for clip, frame in (start, end))
    leads = graph.exits[start[0]]
    hint = (
        f"nothing leads on from {graph.names[start[0]]} after frame {leads}"
        if start[1] > leads
        else f"{graph.names[end[0]]} is not in the part of the graph that leads from there"
    )
    return InputError(
        f"{here} to {there}: expected a way at tau {graph.tau:g}, found none: {hint}.\n"
        "Take a larger --tau, or other frames."
    )
