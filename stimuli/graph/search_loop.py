"""The randomised search of section 4.2, compiled: mutations, climbing, local minima.

Two kinds of mutations, as in 4.2.2: (a) what lies between two edges of a path is deleted and
replaced by nothing or by one or two edges of G′; (b) edges, one or two at once, are replaced by
children. Ours beside them: an edge goes over to one near it in its tree, as children of children
would be reached one by one.
"""

import numpy as np
import numpy.typing as npt

from stimuli.compiled import compiled
from stimuli.graph.score_loop import LONGEST, Aim, Space, Trace, Whole, score_path
from stimuli.graph.walk_loop import Random, draw, entered, random_walk, walk_to_poses, within
from stimuli.motion.quaternions import Array

Places = npt.NDArray[np.int64]
Flags = npt.NDArray[np.bool_]

SEEDS = 40  # walks through poses of which the best is a seed
SCARCE = 1e-9  # scores that differ by less are equal


@compiled(nogil=True)
def near(space: Space, random: Random, node: int) -> int:
    """A child of a node, or a node near it in its tree."""
    if space.right[node] and draw(random, 2):
        return node + 1 if draw(random, 2) else space.right[node]
    root = np.searchsorted(space.roots, node, side="right") - 1
    low, high = space.roots[root], space.roots[root + 1]
    away = 1 + draw(random, 1 << (1 + draw(random, 6)))
    other = node + away if draw(random, 2) else node - away
    if low <= other < high:
        return other
    return low + draw(random, high - low)


@compiled(nogil=True)
def mutated(
    space: Space, aim: Aim, random: Random, path: Whole, count: int, new: Whole
) -> tuple[int, int]:
    """A random mutation of a path, written to `new`: how many nodes it has, 0 where it fails.

    And the first piece that may be another.
    """
    held = aim.locked
    if count < held:
        return 0, 0
    if draw(random, 2) and count > held:
        new[:count] = path[:count]
        first = held + draw(random, count - held)
        new[first] = near(space, random, path[first])
        if draw(random, 3):
            second = held + draw(random, count - held)
            new[second] = near(space, random, path[second])
            first = min(first, second)
        return count, max(first - 1, 0)
    p = held + draw(random, count + 1 - held) - 1
    q = min(p + 1 + draw(random, 1 + draw(random, 5)), count)
    return _replaced(space, random, path, count, p, q, draw(random, 5), new), max(p, 0)


@compiled(nogil=True)
def _replaced(
    space: Space, random: Random, path: Whole, count: int, p: int, q: int, kind: int, new: Whole
) -> int:  # fmt: skip
    """What lies between nodes p and q replaced by no edge (kind 0), one (1, 2) or two (3, 4).

    p is −1 where the start goes too, q is `count` where the end does.
    """
    none = len(space.frames) - 1
    left = none if p < 0 else space.node_to[path[p]]
    hops = (kind + 1) // 2
    if p < 0 and hops == 0:
        return 0
    if p + 1 + hops + count - q > LONGEST:
        return 0
    new[: p + 1] = path[: p + 1]
    place = p + 1
    for hop in range(hops):
        if hop == hops - 1 and q < count:
            right = space.node_from[path[q]]
            low, high = space.pair[left, right], space.pair[left, right + 1]
        else:
            low, high = space.pair[left, 0], space.pair[left, none]
        if high <= low:
            return 0
        node = within(space, random, low + draw(random, high - low))
        if place and space.node_i[node] <= space.node_j[new[place - 1]]:
            return 0
        new[place] = node
        left = space.node_to[node]
        place += 1
    if q < count:
        if left != space.node_from[path[q]] or place == 0:
            return 0
        if space.node_i[path[q]] <= space.node_j[new[place - 1]]:
            return 0
    new[place : place + count - q] = path[q:count]
    return place + count - q


@compiled(nogil=True)
def climb(
    space: Space, aim: Aim, random: Random, path: Whole, count: int, score: float,
    most: int, trace: Trace, spare: Trace,
) -> tuple[int, float, int, bool]:  # fmt: skip
    """Betters a path in place by random mutations, then by all, until none does or `most` are tried.

    Returns its nodes, its score, how many mutations were scored, and whether it is a local minimum.
    """
    new = np.empty(LONGEST, np.int32)
    tried, idle = 0, 0
    score_path(space, aim, path, count, aim.frames, np.inf, trace, 0, trace)
    while tried < most:
        length, since = mutated(space, aim, random, path, count, new)
        tried += 1
        idle += 1
        if length:
            value, used = score_path(
                space, aim, new, length, aim.frames, score, trace, since, spare
            )
            if value < score - SCARCE:
                path[:used] = new[:used]
                count, score, idle = used, value, 0
                score_path(space, aim, path, count, aim.frames, np.inf, trace, 0, trace)
        if idle >= aim.effort[2]:
            count, better, spent = best_of_all(space, aim, path, count, score, new, trace, spare)
            tried += spent
            if better >= score - SCARCE:
                return count, score, tried, True
            score, idle = better, 0
            score_path(space, aim, path, count, aim.frames, np.inf, trace, 0, trace)
    return count, score, tried, False


@compiled(nogil=True)
def best_of_all(
    space: Space, aim: Aim, path: Whole, count: int, score: float, new: Whole, trace: Trace,
    spare: Trace,
) -> tuple[int, float, int]:  # fmt: skip
    """The best of all mutations (b), and of (a) by no edge or one, written to `path` if better."""
    best = path.copy()
    kept, least, tried = count, score, 0
    none = len(space.frames) - 1
    for p in range(aim.locked, count):
        for q in range(p, count):
            for choice in range(4 if q > p else 2):
                if not _demoted(space, path, count, p, q, choice, new):
                    continue
                value, used = score_path(
                    space, aim, new, count, aim.frames, least, trace, max(p - 1, 0), spare
                )
                tried += 1
                if value < least - SCARCE:
                    least, kept = value, used
                    best[:used] = new[:used]
    for p in range(aim.locked - 1, count):
        for q in range(p + 1, count + 1):
            left = none if p < 0 else space.node_to[path[p]]
            new[: p + 1] = path[: p + 1]
            new[p + 2 : p + 2 + count - q] = path[q:count]
            low, high = space.pair[left, 0], space.pair[left, none]
            if q < count:
                right = space.node_from[path[q]]
                low, high = space.pair[left, right], space.pair[left, right + 1]
            if p + 2 + count - q > LONGEST:
                continue
            for root in range(low, high):
                node = space.roots[root]
                if p >= 0 and space.node_i[node] <= space.node_j[path[p]]:
                    continue
                new[p + 1] = node
                value, used = score_path(
                    space, aim, new, p + 2 + count - q, aim.frames, least, trace, max(p, 0), spare
                )
                tried += 1
                if value < least - SCARCE:
                    least, kept = value, used
                    best[:used] = new[:used]
            if p >= 0 and q > p + 1:
                new[p + 1 : p + 1 + count - q] = path[q:count]
                value, used = score_path(
                    space, aim, new, p + 1 + count - q, aim.frames, least, trace, max(p, 0), spare
                )
                tried += 1
                if value < least - SCARCE:
                    least, kept = value, used
                    best[:used] = new[:used]
    path[:kept] = best[:kept]
    return kept, least, tried


@compiled(nogil=True)
def _demoted(
    space: Space, path: Whole, count: int, p: int, q: int, choice: int, new: Whole
) -> bool:
    """Nodes p and q (or p alone, where q is p) replaced by one of each one's children, if any."""
    new[:count] = path[:count]
    some = False
    for at, second in ((p, choice & 1), (q, choice >> 1)):
        node = path[at]
        if space.right[node] and new[at] == node:
            new[at] = space.right[node] if second else node + 1
            some = True
    return some


@compiled(nogil=True)
def shaken(space: Space, aim: Aim, random: Random, path: Whole, count: int, trace: Trace) -> (
    tuple[int, float]
):  # fmt: skip
    """A path with some mutations in a row, whatever they cost: its nodes and score, 0 for none."""
    new = np.empty(LONGEST, np.int32)
    value = np.inf
    for _ in range(1 + draw(random, 3)):
        for _ in range(50):
            length, _ = mutated(space, aim, random, path, count, new)
            if length == 0:
                continue
            found, used = score_path(space, aim, new, length, aim.frames, np.inf, trace, 0, trace)
            if found < np.inf:
                path[:used] = new[:used]
                count, value = used, found
                break
    return (count, value) if value < np.inf else (0, value)


@compiled(nogil=True)
def search_on(
    space: Space, aim: Aim, random: Random, current: Whole, kept: Whole, counts: Places,
    scores: Array, by_frame: Places, first_of: Places, reached: Flags, most: int, trace: Trace,
    spare: Trace,
) -> int:  # fmt: skip
    """Goes on with a search for about `most` mutations; returns how many it tried.

    The state of a search are its generator, the path that it climbs from (`current`; its nodes and
    score the last of `counts` and `scores`) and the local minima that it keeps, each of clips of
    its own: `kept` (K, LONGEST), `counts` (K + 1,), `scores` (K + 1,). `by_frame`, `first_of` and
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
    space: Space, aim: Aim, random: Random, path: Whole, count: int, trace: Trace, spare: Trace
) -> tuple[int, float]:
    """A path of `count` nodes gone on with from one demand to the next, written in place.

    Of random walks up to a demand's time the best few are kept, and gone on with.
    """
    beam, counts = np.empty((aim.effort[0], LONGEST), np.int32), np.zeros(aim.effort[0], np.int64)
    beam[0], counts[0] = path, count
    many, before = 1, entered(space, path, count)
    new = np.empty(LONGEST, np.int32)
    least, best = np.inf, 0
    for stop in aim.stops:
        if count and stop <= before + 1:
            continue
        ahead, lengths = (
            np.empty((aim.effort[0], LONGEST), np.int32),
            np.zeros(aim.effort[0], np.int64),
        )
        scores = np.full(aim.effort[0], np.inf)
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
        many = np.sum(scores < np.inf)
        if many == 0:
            return 0, np.inf
        beam, counts, before = ahead, lengths, stop
        least, best = scores[0], lengths[0]
    if best:
        path[:best] = beam[0, :best]
    return best, least


@compiled(nogil=True)
def _into_beam(
    path: Whole, count: int, score: float, beam: Whole, counts: Places, scores: Array
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
    space: Space, aim: Aim, random: Random, current: Whole, kept: Whole, counts: Places,
    scores: Array, by_frame: Places, first_of: Places, reached: Flags, trace: Trace, spare: Trace,
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
    path = np.empty(LONGEST, np.int32)
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
    space: Space, path: Whole, count: int, score: float, kept: Whole, counts: Places, scores: Array
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
def _same_clips(space: Space, one: Whole, count: int, other: Whole, length: int) -> bool:
    if count != length:
        return False
    for k in range(count):
        if space.node_to[one[k]] != space.node_to[other[k]]:
            return False
    return True
