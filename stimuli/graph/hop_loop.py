"""The last edge before a demand is chosen among all edges of G′, compiled: what paths grow by.

Edges lie by the clip that they leave, then by the frame, each with what it does to the floor, so
that one costs some nanoseconds. 4.2.2 enumerates edges that join two pieces of a path the same way.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from stimuli.compiled import compiled
from stimuli.graph.arrays import Complex, Indices
from stimuli.graph.score_loop import TEN_DEGREES, Space


class Hops(NamedTuple):
    """The edges of G′ in order of the clips and the frames that they leave."""

    first: Indices  # (N + 1,) where the edges that leave each clip begin
    node: Indices  # (R,)
    i: Indices  # (R,) frame left
    j: Indices  # (R,) frame entered
    to: Indices  # (R,) clip entered
    cost: npt.NDArray[np.float32]  # (R,)
    turn: Complex  # (R,) from the floor of the clip entered to that of the clip left
    shift: Complex  # (R,)
    start: Indices  # (F,) the edge at which a motion starts with each frame


def hops_of(space: Space) -> Hops:
    """The edges of G′, without those at which a motion starts."""
    none = len(space.frames) - 1
    nodes = space.roots[: space.pair[none, 0]]
    clip, i = space.node_from[nodes], space.node_i[nodes]
    nodes = nodes[np.lexsort((i, clip))]
    clip, i, j, to = (
        part[nodes] for part in (space.node_from, space.node_i, space.node_j, space.node_to)
    )
    left, onto = space.first[clip] + i, space.first[to] + j
    turn = space.turn[left] * np.conj(space.turn[onto])
    begins = np.arange(space.roots[space.pair[none, 0]], len(space.right))
    begins = begins[space.right[begins] == 0]
    start = np.empty(len(space.place), dtype=np.int32)
    start[space.first[space.node_to[begins]] + space.node_j[begins] + 1] = begins
    return Hops(
        np.searchsorted(clip, np.arange(none + 1)).astype(np.int32),
        nodes, i, j, to, space.node_cost[nodes], turn,
        space.place[left] - turn * space.place[onto], start,
    )  # fmt: skip


@compiled(nogil=True)
def window(hops: Hops, clip: int, low: int, high: int) -> tuple[int, int]:
    """Which edges leave a clip at the frames `low` to `high`, both included."""
    start, stop = hops.first[clip], hops.first[clip + 1]
    here = hops.i[start:stop]
    return (
        start + np.searchsorted(here, low, side="left"),
        start + np.searchsorted(here, high, side="right"),
    )


@compiled(nogil=True)
def last_hop(
    space: Space, hops: Hops, clip: int, low: int, high: int, until: int, rest: int,
    place: complex, turn: complex, weight: float, cut_weight: float, bound: float,
) -> tuple[int, float]:  # fmt: skip
    """The edge by which a body in a clip gets nearest to a place and heading, −1 for none.

    It leaves at frames `low` to `high`; the body is to be there when the clip, played on, would be
    at frame `until`. Place and turn are on the clip's own floor. And what the cut and the miss
    cost, which is below `bound`. `rest` frames are to follow.
    """
    start, stop = window(hops, clip, low, high)
    best, least = -1, bound
    back = np.conj(turn)
    for hop in range(start, stop):
        cost = cut_weight * hops.cost[hop]
        if cost >= least:
            continue
        onto = hops.to[hop]
        frame = hops.j[hop] + until - hops.i[hop]
        if frame >= space.frames[onto] or (
            frame > space.exits[onto] and frame + rest >= space.frames[onto]
        ):
            continue
        g = space.first[onto] + frame
        apart = hops.shift[hop] + hops.turn[hop] * space.place[g] - place
        cost += weight * (apart.real * apart.real + apart.imag * apart.imag) / 0.09
        if cost >= least:
            continue
        facing = hops.turn[hop] * space.turn[g] * back
        angle = np.arctan2(facing.imag, facing.real) / TEN_DEGREES
        cost += weight * angle * angle
        if cost < least:
            best, least = hop, cost
    return best, least
