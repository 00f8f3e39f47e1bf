"""Paths that are grown from one demand to the next, compiled: what a climb begins with (4.2).

The paper grows its seeds from hard demands outwards; so are these from any: of many ways up to a
demand's time the best few are gone on with. A way is an edge or two of G′ at random, and behind
them the one of all edges that brings the body nearest to where it is demanded; where a time is of
another demand, a random walk.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from stimuli.compiled import compiled
from stimuli.graph.arrays import Flags, Indices, Rows
from stimuli.graph.hop_loop import Hops, last_hop, window
from stimuli.graph.score_loop import MOST_NODES, Aim, Space, Trace, score_path
from stimuli.graph.walk_loop import Random, draw, entered, random_walk, walk_to_poses

MOMENT = 8  # frames
TOO_FAR = 150  # frames before a demand that one or two edges do not bridge
SEEDS = 40  # walks through poses of which the best is begun with


class Beams(NamedTuple):
    """The best ways found so far up to the time of each demand, best first (S, W, …)."""

    path: npt.NDArray[np.int32]
    nodes: npt.NDArray[np.int64]  # how many each has
    score: npt.NDArray[np.float64]  # infinite where there is none
    end: npt.NDArray[np.int64]  # the moment that each ends in


def new_beams(aim: Aim) -> Beams:
    """Beams that nothing is in."""
    shape = (len(aim.stops), int(aim.effort[0]))
    return Beams(
        np.zeros((*shape, MOST_NODES), np.int32), np.zeros(shape, np.int64),
        np.full(shape, np.inf), np.full(shape, -1),
    )  # fmt: skip


@compiled(nogil=True)
def grown(
    space: Space, hops: Hops, aim: Aim, random: Random, path: Indices, count: int, beams: Beams,
    trace: Trace, spare: Trace,
) -> None:  # fmt: skip
    """Goes on with all ways that are kept, each to the demand after it, and keeps the best.

    The first of them go on with a path of `count` nodes.
    """
    before = entered(space, path, count)
    new = np.empty(MOST_NODES, np.int32)
    level = -1
    for number, stop in enumerate(aim.stops):
        if count and stop <= before + 1:
            continue
        many = 1 if level < 0 else int(np.sum(beams.score[level] < np.inf))
        body = np.searchsorted(aim.body_at, stop - 1)
        aimed = body < len(aim.body_at) and aim.body_at[body] == stop - 1
        for b in range(many):
            had = count if level < 0 else beams.nodes[level, b]
            new[:had] = path[:had] if level < 0 else beams.path[level, b, :had]
            if had:
                score_path(space, aim, new, had, stop, np.inf, trace, 0, trace)
            time, since = entered(space, new, had), max(had - 1, 0)
            for n in range(aim.effort[1] // many):
                most = beams.score[number, -1]
                if aimed:
                    length = _aimed_way(
                        space, hops, aim, random, new, had, time, before, stop, body, n, most, trace
                    )
                else:
                    length = random_walk(
                        space, random, new, had, time, before, stop, aim.shortest, False
                    )
                if length:
                    score, used = score_path(
                        space, aim, new, length, stop, most, trace, since, spare
                    )
                    _into_beam(space, beams, number, stop, new, used, score)
        level, before = number, stop


@compiled(nogil=True)
def _aimed_way(
    space: Space, hops: Hops, aim: Aim, random: Random, path: Indices, count: int, time: int,
    since: int, stop: int, body: int, n: int, bound: float, trace: Trace,
) -> int:  # fmt: skip
    """Goes on with a path to where the body is demanded at `stop` − 1; how many nodes it has then.

    For `time` and `since` see `random_walk`; `n` counts the ways tried. `trace` is of the path.
    """
    if count == 0:
        start = draw(random, len(space.place))
        path[0] = hops.start[start]
        clip, j = space.node_to[path[0]], space.node_j[path[0]]
        turn = aim.body_turn[0] * np.conj(space.turn[start])
        shift, total = aim.body_place[0] - turn * space.place[start], 0.0
        count, more = 1, draw(random, 3)
    else:
        clip, j = space.node_to[path[count - 1]], space.node_j[path[count - 1]]
        turn, shift, total = trace.turn[count - 1], trace.shift[count - 1], trace.total[count - 1]
        if n == 0:
            return count
        more = 0 if n == 1 else 1 + (draw(random, 4) == 0)
    while (more > 0 or stop - time > TOO_FAR) and count < MOST_NODES - 1:
        low, high = window(
            hops, clip, j + max(aim.shortest, since - time),
            min(j + stop - 2 - time, space.exits[clip]),
        )  # fmt: skip
        if high <= low:
            break
        hop = low + draw(random, high - low)
        total += aim.cut_weight * hops.cost[hop]
        if total >= bound:
            return 0
        shift += turn * hops.shift[hop]
        turn *= hops.turn[hop]
        time += hops.i[hop] - j
        clip, j = hops.to[hop], hops.j[hop]
        path[count] = hops.node[hop]
        count, more = count + 1, more - 1
    until = j + stop - time
    rest = aim.frames - stop
    back = np.conj(turn)
    hop, _ = last_hop(
        space, hops, clip, j + max(aim.shortest, since - time),
        until - (1 if rest else aim.shortest), until, rest, (aim.body_place[body] - shift) * back,
        aim.body_turn[body] * back, aim.body_weight[body], aim.cut_weight, bound - total,
    )  # fmt: skip
    if hop < 0 or count == MOST_NODES:
        return count if until < space.frames[clip] else 0
    path[count] = hops.node[hop]
    return count + 1


@compiled(nogil=True)
def _end(space: Space, path: Indices, count: int, stop: int) -> int:
    """Which moment of all clips, of a quarter of a second each, a path is in at a time."""
    clip, j = space.node_to[path[count - 1]], space.node_j[path[count - 1]]
    frame = min(j + stop - entered(space, path, count), space.frames[clip] - 1)
    return (space.first[clip] + frame) // MOMENT


@compiled(nogil=True)
def _into_beam(
    space: Space, beams: Beams, level: int, stop: int, path: Indices, count: int, score: float
) -> None:
    """Puts a path among the best few, of which each ends in a moment of its own."""
    scores, ends = beams.score[level], beams.end[level]
    last = len(scores) - 1
    if score >= scores[last]:
        return
    end = _end(space, path, count, stop)
    for k in range(len(scores)):
        if ends[k] == end:
            last = k
            break
    if score >= scores[last]:
        return
    paths, counts = beams.path[level], beams.nodes[level]
    while last and scores[last - 1] > score:
        paths[last], counts[last] = paths[last - 1], counts[last - 1]
        scores[last], ends[last] = scores[last - 1], ends[last - 1]
        last -= 1
    paths[last, :count] = path[:count]
    counts[last], scores[last], ends[last] = count, score, end


@compiled(nogil=True)
def taught(space: Space, aim: Aim, path: Indices, count: int, beams: Beams, trace: Trace) -> None:
    """Puts a path that was bettered into the beams, up to each demand's time."""
    for level, stop in enumerate(aim.stops):
        score, used = score_path(space, aim, path, count, stop, np.inf, trace, 0, trace)
        _into_beam(space, beams, level, stop, path, used, score)


@compiled(nogil=True)
def grown_through(
    space: Space, aim: Aim, random: Random, path: Indices, by_frame: Rows, first_of: Rows,
    reached: Flags, trace: Trace,
) -> tuple[int, float]:  # fmt: skip
    """The best of some walks through all poses that must be hit: its nodes, 0 for none, its score.

    For the tables see `walk_to_poses`.
    """
    least, best = np.inf, 0
    new = np.empty(MOST_NODES, np.int32)
    for _ in range(SEEDS):
        length = walk_to_poses(space, aim, random, new, by_frame, first_of, reached)
        if length:
            score, used = score_path(space, aim, new, length, aim.frames, least, trace, 0, trace)
            if score < least:
                least, best = score, used
                path[:used] = new[:used]
    return best, least
