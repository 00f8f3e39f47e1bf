"""The search for a motion that meets demands, which can be stopped at any moment and goes on.

Two crews search apart, each from a seed of its own, on two cores where there are; what they have
kept is put together. The same seed and number of mutations give the same motions.
"""

import math
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from stimuli.collection import Collection
from stimuli.errors import InputError
from stimuli.graph.aim import aim_at
from stimuli.graph.crew import PoseWays, SearchCrew
from stimuli.graph.demands import Demands
from stimuli.graph.graph import MotionGraph
from stimuli.graph.grow_loop import new_beams
from stimuli.graph.hop_loop import Hops, hops_of
from stimuli.graph.plan import MotionPlan, Stretch, motion_plan
from stimuli.graph.score_loop import Aim, Space, new_trace

CREWS = 2
QUANTUM = 4000  # mutations between two looks at the clock
Tell = Callable[[float, float], None]  # seconds gone, the best score so far


@dataclass(frozen=True, eq=False)
class Search:
    """A search for one figure's demands over a graph; `go` may be called again and goes on."""

    demands: Demands
    collection: Collection
    space: Space
    hops: Hops
    aim: Aim
    ways: PoseWays
    crews: tuple[SearchCrew, ...]

    def go(
        self, *, seconds: float | None = None, mutations: int | None = None,
        tell: Tell | None = None,
    ) -> bool:  # fmt: skip
        """Search until the time is over or so many mutations are tried; False where interrupted.

        Ctrl-C ends it too: what was found so far is kept.
        """
        stop = threading.Event()
        end = None if seconds is None else time.monotonic() + seconds
        share = None if mutations is None else -(-mutations // len(self.crews))
        goals = [None if share is None else crew.tried + share for crew in self.crews]
        begun = time.monotonic()
        with ThreadPoolExecutor(len(self.crews)) as pool:
            work = [
                pool.submit(self._work, crew, goal, end, stop)
                for crew, goal in zip(self.crews, goals, strict=True)
            ]
            try:
                while not all(done.done() for done in work):
                    if tell:
                        tell(time.monotonic() - begun, self.best)
                    _wait(work)
                for done in work:
                    done.result()
            except KeyboardInterrupt:
                stop.set()
                return False
        return True

    def _work(
        self, crew: SearchCrew, goal: int | None, end: float | None, stop: threading.Event
    ) -> None:
        while not stop.is_set():
            most = QUANTUM if goal is None else min(QUANTUM, goal - crew.tried)
            if most <= 0 or (end is not None and time.monotonic() >= end):
                break
            crew.go_on(self.space, self.hops, self.aim, self.ways, most)

    @property
    def best(self) -> float:
        """The best score so far, infinite before there is a path."""
        return min((crew.kept[0].score for crew in self.crews if crew.kept), default=math.inf)

    @property
    def tried(self) -> int:
        """How many mutations were scored."""
        return sum(crew.tried for crew in self.crews)

    def plans(self, count: int = 1) -> list[MotionPlan]:
        """The best `count` motions found, best first, each made of other clips than those before.

        InputError where there is none.
        """
        found = [answer for crew in self.crews for answer in crew.kept]
        if not found:
            raise InputError(
                "search: expected a motion through all poses at their times, found none.\n"
                "Give it more --seconds, or the poses other times."
            )
        chosen: list[MotionPlan] = []
        seen: list[frozenset[int]] = []
        for answer in sorted(found, key=lambda a: (a.score, a.path.tolist())):
            clips = frozenset(answer.clips)
            if clips not in seen and len(chosen) < count:
                seen.append(clips)
                pieces = self.pieces(answer.path)
                chosen.append(motion_plan(self.demands, pieces, self.collection))
        return chosen

    def pieces(self, path: np.ndarray) -> list[Stretch]:
        """The stretches of clips that a path plays."""
        space, left, pieces = self.space, self.aim.frames, []
        for n, node in enumerate(path):
            clip, first = int(space.node_to[node]), int(space.node_j[node]) + 1
            last = int(space.frames[clip]) - 1
            if n + 1 < len(path):
                last = int(space.node_i[path[n + 1]])
            last = min(last, first + left - 1)
            cost = float(space.node_cost[node]) if n else 0.0
            pieces.append(Stretch(clip, first, last, cost))
            left -= last - first + 1
        return pieces


def _wait(work: Sequence[object]) -> None:
    from concurrent.futures import wait

    wait(work, timeout=0.05)  # type: ignore[arg-type]


def begin_search(
    demands: Demands,
    graph: MotionGraph,
    collection: Collection,
    space: Space,
    seed: int = 0,
    near: tuple[Sequence[Stretch], int] | None = None,
) -> Search:
    """A search before its first mutation.

    `near` are the pieces of an earlier answer, from which it goes on, and the time until which
    these stay as they are. InputError where poses cannot be reached in time.
    """
    aim = aim_at(demands, collection)
    ways = _pose_ways(demands, graph, space, aim)
    path = None
    if near is not None:
        path = path_of(space, near[0])
        aim = aim._replace(locked=_locked(near[0], near[1]), effort=_staying(aim))
    crews = []
    for number in range(CREWS):
        state = np.random.SeedSequence([seed, number]).generate_state(1, np.uint64) | np.uint64(1)
        crew = SearchCrew(state, (new_trace(aim), new_trace(aim)), new_beams(aim))
        if path is not None:
            _given(crew, path, space, aim)
        crews.append(crew)
    return Search(demands, collection, space, hops_of(space), aim, ways, tuple(crews))


def _staying(aim: Aim) -> np.ndarray:
    """The effort of a search that stays near an answer: every climb begins at a kept path."""
    effort = aim.effort.copy()
    effort[3] = 10
    return effort


def _locked(pieces: Sequence[Stretch], until: int) -> int:
    """How many pieces begin before a time and stay; none where all may change."""
    begins = np.cumsum([0, *(len(piece) for piece in pieces)])[:-1]
    return int((begins < until).sum()) if until > 0 else 0


def _given(crew: SearchCrew, path: np.ndarray, space: Space, aim: Aim) -> None:
    """An earlier answer as what the crew climbs from, and as the first that it keeps."""
    if np.isinf(crew.take_up(space, aim, path)):
        raise InputError(
            "--near: expected a motion that hits the poses demanded, found one that does not.\n"
            "Leave it out: poses that must be hit are looked for from the beginning."
        )


def path_of(space: Space, pieces: Sequence[Stretch]) -> np.ndarray:
    """The nodes of a path that plays these pieces; InputError where the graph lacks an edge."""
    none = len(space.frames) - 1
    path, before, left = [], none, -1
    for piece in pieces:
        low, high = (space.roots[space.pair[before, piece.clip + n]] for n in (0, 1))
        nodes = np.arange(low, high)
        same = (
            (space.right[nodes] == 0)
            & (space.node_i[nodes] == left)
            & (space.node_j[nodes] == piece.first - 1)
        )
        if not same.any():
            raise InputError(
                "--near: expected an answer of this graph, found a cut that it does not have.\n"
                "Search at the --tau and with the --motions that the answer is of."
            )
        path.append(nodes[same][0])
        before, left = piece.clip, piece.last
    return np.array(path, dtype=np.int32)


def _pose_ways(demands: Demands, graph: MotionGraph, space: Space, aim: Aim) -> PoseWays:
    """Tables by which walks reach the poses; InputError for those that none can reach in time."""
    frames = len(space.place)
    nothing = np.zeros(0, dtype=np.int64)
    if not len(aim.pose_at):
        return PoseWays(nothing, nothing, np.zeros((0, frames), dtype=bool))
    from stimuli.graph.walk_loop import pose_reached

    leaves = graph.leaves
    leaves_from = space.first[space.node_from[leaves]] + space.node_i[leaves]
    order = np.argsort(leaves_from, kind="stable")
    by_frame = leaves[order]
    first_of = np.searchsorted(leaves_from[order], np.arange(frames + 1)).astype(np.int64)
    reached = np.zeros((int(aim.pose_at[-1]) + 1, frames), dtype=bool)
    before = 0
    for n, at in enumerate(aim.pose_at):
        target = int(space.first[aim.pose_clip[n]] + aim.pose_frame[n])
        table = pose_reached(space, target, int(at) - before, by_frame, first_of)[::-1]
        here = slice(before + (n > 0), int(at) + 1)
        reached[here] = table[n > 0 :]
        if n and not table[0, int(space.first[aim.pose_clip[n - 1]] + aim.pose_frame[n - 1])]:
            raise _unreached(demands, n, int(at) - before)
        before = int(at)
    return PoseWays(by_frame, first_of, reached)


def _unreached(demands: Demands, n: int, frames: int) -> InputError:
    one, other = demands.of("pose")[n - 1 : n + 1]
    return InputError(
        f"pose {one['clip']}:{one['frame']} to {other['clip']}:{other['frame']}: expected a way of "
        f"{frames} frames, found none.\n`segue graph path` says how long the shortest is; give the "
        "poses other times."
    )
