"""What a crew of the search does, compiled: begins paths, climbs, keeps local minima (4.2).

Seeds are grown from one demand to the next, as the paper does from hard ones: of many random walks
up to its time the best few are gone on with.
"""

import numpy as np

from stimuli.compiled import compiled
from stimuli.graph.arrays import Flags, Indices, Rows
from stimuli.graph.score_loop import MOST_NODES, Aim, Space, Trace, score_path
from stimuli.graph.search_loop import climb, shaken
from stimuli.graph.walk_loop import Random, draw, entered, random_walk, walk_to_poses
from stimuli.motion.quaternions import Array

SEEDS = 40  # walks through poses of which the best is a seed


@compiled(nogil=True)
def search_on(
    space: Space, aim: Aim, random: Random, current: Indices, kept: Indices, counts: Rows,
    scores: Array, by_frame: Rows, first_of: Rows, reached: Flags, most: int, trace: Trace,
    spare: Trace,
) -> int:  # fmt: skip
    """Goes on with a search for about `most` mutations; returns how many it tried.

    The state of a search are its generator, the path that it climbs from (`current`; its nodes and
    score the last of `counts` and `scores`) and the local minima that it keeps, each of clips of
    its own: `kept` (K, MOST_NODES), `counts` (K + 1,), `scores` (K + 1,). `by_frame`, `first_of`,
    `reached` lead to poses that must be hit, and are empty where there are none.
    """
    tried, last = 0, len(kept)
    while tried < most:
        if counts[last] == 0:
            counts[last], scores[last] = _begun(
                space, aim, random, current, kept, counts, scores, by_frame, first_of, reached,
                trace, spare,
            )  # fmt: skip
            tried += SEEDS
            if counts[last] == 0:
                continue
        count, score, spent, least = climb(
            space,
            aim,
            random,
            current,
            counts[last],
            scores[last],
            most - tried,
            trace,
            spare,
        )
        counts[last], scores[last] = count, score
        tried += spent
        keep(space, current, count, score, kept, counts, scores)
        if least:
            counts[last] = 0
    return tried


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
def _begun(
    space: Space, aim: Aim, random: Random, current: Indices, kept: Indices, counts: Rows,
    scores: Array, by_frame: Rows, first_of: Rows, reached: Flags, trace: Trace, spare: Trace,
) -> tuple[int, float]:  # fmt: skip
    """A path to climb from: a kept one that is shaken, or the best of some random walks."""
    last = len(kept)
    some = 0
    while some < last and counts[some]:
        some += 1
    count = 0
    if some and draw(random, 10) < aim.effort[3]:
        chosen = draw(random, 1 + draw(random, some))  # the better the likelier
        current[:] = kept[chosen]
        if draw(random, 3) == 0 or len(reached):
            return shaken(space, aim, random, current, counts[chosen], trace)
        count = aim.locked + draw(random, max(counts[chosen] - aim.locked, 1))
    elif aim.locked:
        current[:] = kept[0]
        count = aim.locked
    if len(reached) == 0:
        return grown(space, aim, random, current, count, trace, spare)
    least, best = np.inf, 0
    path = np.empty(MOST_NODES, np.int32)
    for _ in range(SEEDS):
        length = walk_to_poses(space, aim, random, path, by_frame, first_of, reached)
        if length:
            score, used = score_path(space, aim, path, length, aim.frames, least, trace, 0, trace)
            if score < least:
                least, best = score, used
                current[:used] = path[:used]
    return best, least


@compiled(nogil=True)
def keep(
    space: Space,
    path: Indices,
    count: int,
    score: float,
    kept: Indices,
    counts: Rows,
    scores: Array,
) -> None:
    """Keeps a path where it is among the best, one for each sequence of clips; best first."""
    last = len(kept)
    place = last
    for k in range(last):
        if counts[k] and _same_clips(space, path, count, kept[k], counts[k]):
            if scores[k] <= score:
                return
            place = k
            break
        if counts[k] == 0:
            place = k
            break
    if place == last:
        place = last - 1
        if scores[place] <= score:
            return
    while place and scores[place - 1] > score:
        kept[place], counts[place] = kept[place - 1], counts[place - 1]
        scores[place] = scores[place - 1]
        place -= 1
    kept[place, :count] = path[:count]
    counts[place], scores[place] = count, score


@compiled(nogil=True)
def _same_clips(space: Space, one: Indices, count: int, other: Indices, length: int) -> bool:
    if count != length:
        return False
    same = 0
    while same < count and space.node_to[one[same]] == space.node_to[other[same]]:
        same += 1
    return same == count
