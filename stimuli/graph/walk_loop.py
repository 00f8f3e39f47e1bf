"""Random numbers and random walks over a graph, compiled: what seeds a search, and its rival."""

import numpy as np
import numpy.typing as npt

from stimuli.compiled import compiled
from stimuli.graph.arrays import Indices, Rows
from stimuli.graph.score_loop import MOST_NODES, Aim, Space, Trace, score_path

Random = npt.NDArray[np.uint64]  # (1,) the state of a generator, never 0
_TRIES = 16  # to find an edge that leads on
ON = 0.97  # of the frames of a walk towards a pose that go on in their clip where they can


@compiled(nogil=True)
def draw(random: Random, below: int) -> int:
    """A whole number from 0 to below `below` (xorshift64*, Vigna 2016)."""
    x = random[0]
    x ^= x >> np.uint64(12)
    x ^= x << np.uint64(25)
    x ^= x >> np.uint64(27)
    random[0] = x
    return int((x * np.uint64(2685821657736338717)) >> np.uint64(33)) % below


@compiled(nogil=True)
def chance(random: Random) -> float:
    """A number from 0 to below 1."""
    return draw(random, 1 << 30) / (1 << 30)


@compiled(nogil=True)
def within(space: Space, random: Random, root: int) -> int:
    """A node of a tree, all of its levels alike likely."""
    node = space.roots[root]
    end = space.roots[root + 1]
    while space.right[node] and draw(random, 4):
        node = node + 1 if draw(random, 2) else space.right[node]
    return min(node, end - 1)


@compiled(nogil=True)
def random_walk(
    space: Space, random: Random, path: Indices, count: int, time: int, since: int, frames: int,
    shortest: int, leaves: bool,
) -> int:  # fmt: skip
    """Goes on with a path of `count` nodes until it lasts `frames`; how many it has then.

    `time` is when the clip that it ends in is entered. No new edge leaves a clip before the time
    `since`, nor after fewer than `shortest` frames. By edges of G (`leaves`), else by nodes of any
    level.
    """
    none = len(space.frames) - 1
    if count == 0:
        first, stop = space.pair[none, 0], space.pair[none, none]
        path[0] = _chosen(space, random, first + draw(random, stop - first), leaves)
        count = 1
    while time < frames and count < MOST_NODES:
        clip, j = space.node_to[path[count - 1]], space.node_j[path[count - 1]]
        remains = frames - time
        if space.frames[clip] - 1 - j >= remains and draw(random, 2):
            return count
        first, stop = space.pair[clip, 0], space.pair[clip, none]
        found = -1
        for _ in range(_TRIES if stop > first else 0):
            node = _chosen(space, random, first + draw(random, stop - first), leaves)
            onto = space.node_to[node]
            spent = space.node_i[node] - j
            if spent < shortest or remains - spent < shortest or time + spent < since:
                continue
            stays = space.frames[onto] - 1 - space.node_j[node] >= remains - spent
            if stays or space.node_j[node] < space.exits[onto]:
                found = node
                break
        if found < 0:
            return count
        time += space.node_i[found] - j
        path[count] = found
        count += 1
    return count


@compiled(nogil=True)
def entered(space: Space, path: Indices, count: int) -> int:
    """When the last piece of a path begins."""
    time = 0
    for k in range(count - 1):
        time += space.node_i[path[k + 1]] - space.node_j[path[k]]
    return time


@compiled(nogil=True)
def _chosen(space: Space, random: Random, root: int, leaves: bool) -> int:
    if leaves:
        node = space.roots[root] + draw(random, space.roots[root + 1] - space.roots[root])
        while space.right[node]:
            node = node + 1 if draw(random, 2) else space.right[node]
        return node
    return within(space, random, root)


@compiled(nogil=True)
def walk_to_poses(
    space: Space, aim: Aim, random: Random, path: Indices, by_frame: Rows, first_of: Rows,
    reached: npt.NDArray[np.bool_],
) -> int:  # fmt: skip
    """The same through all poses that must be hit, at their times.

    `reached` (T + 1, F) says from which frame at which time the next pose is reached in time;
    `by_frame` are the leaves in order of the frames that they leave, which begin at `first_of`.
    """
    starts = np.flatnonzero(reached[0])
    g = starts[draw(random, len(starts))]
    clip = np.searchsorted(space.first, g, side="right") - 1
    path[0] = _start_at(space, clip, g - space.first[clip] - 1)
    count, since = 1, 0
    for time in range(aim.pose_at[-1]):
        after = g + 1
        stays = after < space.first[clip + 1] and reached[time + 1, after]
        cut = -1
        if time + 1 - since >= aim.shortest and (not stays or chance(random) > ON):
            cut = _any_cut(space, random, by_frame, first_of, reached[time + 1], g)
        if cut >= 0 and count < MOST_NODES:
            path[count] = cut
            count, since = count + 1, time + 1
            clip = space.node_to[cut]
            after = space.first[clip] + space.node_j[cut] + 1
        elif not stays:
            return 0
        g = after
    return random_walk(
        space,
        random,
        path,
        count,
        entered(space, path, count),
        aim.pose_at[-1] + 1,
        aim.frames,
        aim.shortest,
        False,
    )


@compiled(nogil=True)
def _any_cut(
    space: Space, random: Random, by_frame: Rows, first_of: Rows,
    good: npt.NDArray[np.bool_], g: int,
) -> int:  # fmt: skip
    """An edge that leaves frame g for one from which the pose is reached, the first of a round."""
    low, high = first_of[g], first_of[g + 1]
    if high <= low:
        return -1
    begin = draw(random, high - low)
    for n in range(high - low):
        leaf = by_frame[low + (begin + n) % (high - low)]
        clip = space.node_to[leaf]
        after = space.node_j[leaf] + 1
        if after < space.frames[clip] and good[space.first[clip] + after]:
            return leaf
    return -1


@compiled(nogil=True)
def _start_at(space: Space, clip: int, j: int) -> int:
    """The leaf at which a motion starts in a clip after frame j."""
    none = len(space.frames) - 1
    for root in range(space.pair[none, clip], space.pair[none, clip + 1]):
        for node in range(space.roots[root], space.roots[root + 1]):
            if space.right[node] == 0 and space.node_j[node] == j:
                return node
    return -1


@compiled(nogil=True)
def pose_reached(
    space: Space, pose: int, steps: int, by_frame: Rows, first_of: Rows
) -> npt.NDArray[np.bool_]:
    """From which frames (steps + 1, F) a frame is reached in 0, 1 … steps frames exactly."""
    frames = len(space.place)
    reached = np.zeros((steps + 1, frames), dtype=np.bool_)
    reached[0, pose] = True
    for step in range(1, steps + 1):
        before, here = reached[step - 1], reached[step]
        for clip in range(len(space.frames) - 1):
            for g in range(space.first[clip], space.first[clip + 1]):
                good = g + 1 < space.first[clip + 1] and before[g + 1]
                n = first_of[g]
                while not good and n < first_of[g + 1]:
                    onto = space.node_to[by_frame[n]]
                    j = space.node_j[by_frame[n]]
                    good = j + 1 < space.frames[onto] and before[space.first[onto] + j + 1]
                    n += 1
                here[g] = good
    return reached


@compiled(nogil=True)
def best_walk(
    space: Space, aim: Aim, random: Random, walks: int, leaves: bool, best: Indices, trace: Trace
) -> tuple[float, int]:
    """The best of so many random walks, its score and how many nodes it has, 0 for none."""
    path = np.empty(MOST_NODES, np.int32)
    least, kept = np.inf, 0
    for _ in range(walks):
        count = random_walk(space, random, path, 0, 0, 0, aim.frames, aim.shortest, leaves)
        score, used = score_path(space, aim, path, count, aim.frames, least, trace, 0, trace)
        if score < least:
            least, kept = score, used
            best[:used] = path[:used]
    return least, kept
