"""Paths that are grown from one demand to the next, compiled: what a climb begins with (4.2).

The paper grows its seeds from hard demands outwards; so are these from any: of many random walks up
to a demand's time the best few are gone on with.
"""

import numpy as np

from stimuli.compiled import compiled
from stimuli.graph.arrays import Flags, Indices, Rows
from stimuli.graph.score_loop import MOST_NODES, Aim, Space, Trace, score_path
from stimuli.graph.walk_loop import Random, entered, random_walk, walk_to_poses
from stimuli.motion.quaternions import Array

SEEDS = 40  # walks through poses of which the best is begun with


@compiled(nogil=True)
def grown(
    space: Space, aim: Aim, random: Random, path: Indices, count: int, trace: Trace, spare: Trace
) -> tuple[int, float]:
    """A path of `count` nodes gone on with from one demand to the next, written in place.

    Of random walks up to a demand's time the best few are kept, and gone on with.
    """
    wide = aim.effort[0]
    beam, counts = (
        np.empty((wide, MOST_NODES), np.int32),
        np.zeros(wide, np.int64),
    )
    beam[0], counts[0] = path, count
    many, before = 1, entered(space, path, count)
    new = np.empty(MOST_NODES, np.int32)
    least, best = np.inf, 0
    for stop in aim.stops:
        if count and stop <= before + 1:
            continue
        ahead, lengths = (
            np.empty((wide, MOST_NODES), np.int32),
            np.zeros(wide, np.int64),
        )
        scores = np.full(wide, np.inf)
        for b in range(many):
            had = counts[b]
            new[:had] = beam[b, :had]
            if had:
                score_path(space, aim, new, had, stop, np.inf, trace, 0, trace)
            time, since = entered(space, new, had), max(had - 1, 0)
            for _ in range(aim.effort[1] // many):
                length = random_walk(space, random, new, had, time, before, stop, False)
                score, used = score_path(
                    space, aim, new, length, stop, scores[-1], trace, since, spare
                )
                _into_beam(new, used, score, ahead, lengths, scores)
        many = int(np.sum(scores < np.inf))
        if many == 0:
            return 0, np.inf
        beam, counts, before = ahead, lengths, stop
        least, best = scores[0], lengths[0]
    if best:
        path[:best] = beam[0, :best]
    return best, least


@compiled(nogil=True)
def _into_beam(
    path: Indices, count: int, score: float, beam: Indices, counts: Rows, scores: Array
) -> None:
    """Puts a path among the best few, unless one of the same score is there."""
    last = len(scores) - 1
    if score >= scores[last] or np.any(scores == score):
        return
    while last and scores[last - 1] > score:
        beam[last], counts[last], scores[last] = beam[last - 1], counts[last - 1], scores[last - 1]
        last -= 1
    beam[last, :count] = path[:count]
    counts[last], scores[last] = count, score


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
