"""The randomised search of section 4.2, compiled: mutations, climbing, local minima.

Two kinds of mutations, as in 4.2.2: (a) what lies between two edges of a path is deleted and
replaced by nothing or by one or two edges of G′; (b) edges, one or two at once, are replaced by
children. Ours beside them: an edge goes over to one near it in its tree, as children of children
would be reached one by one.
"""

import numpy as np

from stimuli.compiled import compiled
from stimuli.graph.arrays import Indices
from stimuli.graph.score_loop import MOST_NODES, Aim, Space, Trace, score_path
from stimuli.graph.walk_loop import Random, draw, within

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
    space: Space, aim: Aim, random: Random, path: Indices, count: int, new: Indices
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
    space: Space, random: Random, path: Indices, count: int, p: int, q: int, kind: int, new: Indices
) -> int:  # fmt: skip
    """What lies between nodes p and q replaced by no edge (kind 0), one (1, 2) or two (3, 4).

    p is −1 where the start goes too, q is `count` where the end does.
    """
    none = len(space.frames) - 1
    left = none if p < 0 else space.node_to[path[p]]
    hops = (kind + 1) // 2
    if p < 0 and hops == 0:
        return 0
    if p + 1 + hops + count - q > MOST_NODES:
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
    space: Space, aim: Aim, random: Random, path: Indices, count: int, score: float,
    most: int, trace: Trace, spare: Trace,
) -> tuple[int, float, int, int]:  # fmt: skip
    """Betters a path in place by random mutations, until many in a row do not or `most` are tried.

    Returns its nodes, its score, how many mutations were tried, and the last of them in vain.
    """
    new = np.empty(MOST_NODES, np.int32)
    tried, idle = 0, 0
    score_path(space, aim, path, count, aim.frames, np.inf, trace, 0, trace)
    while tried < most and idle < aim.effort[2]:
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
    return count, score, tried, idle


@compiled(nogil=True)
def best_of_all(
    space: Space, aim: Aim, path: Indices, count: int, score: float, new: Indices, trace: Trace,
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
            if p + 2 + count - q > MOST_NODES:
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
    space: Space, path: Indices, count: int, p: int, q: int, choice: int, new: Indices
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
