"""A crew of the search (4.2): begins paths, climbs, keeps local minima; what it does is compiled.

The loops are entered from here, a few milliseconds each, rather than from one another: a compiler
would put each of them into all that call it, and take minutes.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from stimuli.graph.grow_loop import Beams
from stimuli.graph.hop_loop import Hops
from stimuli.graph.score_loop import MOST_NODES, Aim, Space, Trace

KEPT = 16  # local minima of a crew, each of clips of its own
WAITING = 4  # grown paths that are climbed from before others are grown
SHAKES = 50  # tries at a mutation that gives a path


@dataclass(frozen=True, eq=False)
class PoseWays:
    """How poses that must be hit are reached in time (see `walk_to_poses`); empty for none."""

    by_frame: np.ndarray
    first_of: np.ndarray
    reached: np.ndarray


@dataclass(frozen=True, eq=False)
class KeptPath:
    """A path that is kept, its score, and the clips that it plays."""

    path: np.ndarray
    score: float
    clips: tuple[int, ...]


@dataclass(eq=False)
class SearchCrew:
    """The state of one search: its generator, the path that it is at, the answers that it keeps.

    `count` is 0 where the next climb begins with another path. `kept` stands best first.
    """

    random: np.ndarray
    traces: tuple[Trace, Trace]
    beams: Beams
    path: np.ndarray = field(default_factory=lambda: np.zeros(MOST_NODES, dtype=np.int32))
    count: int = 0
    score: float = math.inf
    kept: list[KeptPath] = field(default_factory=list)
    waiting: list[np.ndarray] = field(default_factory=list)
    begun: set[bytes] = field(default_factory=set)
    tried: int = 0

    def go_on(self, space: Space, hops: Hops, aim: Aim, ways: PoseWays, most: int) -> None:
        """Climb for about `most` mutations, from where it is or from another path."""
        from stimuli.graph.grow_loop import taught
        from stimuli.graph.search_loop import best_of_all, climb

        if not self.kept and not len(ways.reached) and self._walked(space, aim):
            return
        if self.count == 0:
            self.count, self.score = self._begun(space, hops, aim, ways)
            self.tried += 1
            if self.count == 0:
                return
        self.count, self.score, spent, idle = climb(
            space, aim, self.random, self.path, self.count, self.score, most, *self.traces
        )
        self.tried += spent
        least = False
        if idle >= aim.effort[2]:  # nothing at random is better: try all
            before, new = self.score, np.empty_like(self.path)
            self.count, self.score, spent = best_of_all(
                space, aim, self.path, self.count, self.score, new, *self.traces
            )
            self.tried += spent
            least = self.score >= before - 1e-9
        self.keep(space)
        if least:
            taught(space, aim, self.path, self.count, self.beams, self.traces[0])
            self.count = 0

    def _walked(self, space: Space, aim: Aim) -> bool:
        """Whether a random walk gives a first path, so that there is one at once."""
        from stimuli.graph.walk_loop import random_walk

        path = np.zeros_like(self.path)
        for _ in range(SHAKES):
            count = random_walk(space, self.random, path, 0, 0, 0, aim.frames, aim.shortest, False)
            self.tried += 1
            if math.isfinite(self.take_up(space, aim, path[:count])):
                self.count = 0
                return True
        return False

    def _begun(self, space: Space, hops: Hops, aim: Aim, ways: PoseWays) -> tuple[int, float]:
        """A path to climb from: a kept one, shaken or grown anew in part, or a new one."""
        from stimuli.graph.grow_loop import grown_through, new_beams
        from stimuli.graph.walk_loop import draw

        if self.kept and draw(self.random, 10) < aim.effort[3]:
            # the better the likelier
            chosen = self.kept[draw(self.random, 1 + draw(self.random, len(self.kept)))].path
            if len(ways.reached) or draw(self.random, 4):
                self.path[: len(chosen)] = chosen
                return self._shaken(space, aim, len(chosen))
            count = aim.locked + draw(self.random, max(len(chosen) - aim.locked, 1))
            paths = self._grown(space, hops, aim, chosen[:count], new_beams(aim), 1)
        elif len(ways.reached):
            found = grown_through(
                space, aim, self.random, self.path, ways.by_frame, ways.first_of, ways.reached,
                self.traces[0],
            )  # fmt: skip
            return int(found[0]), float(found[1])
        else:
            if not self.waiting:
                held = self.kept[0].path[: aim.locked] if self.kept else self.path[:0]
                self.waiting = self._grown(space, hops, aim, held, self.beams, WAITING)
            paths = [self.waiting.pop(0)] if self.waiting else []
        return self._stand(space, aim, paths[0]) if paths else (0, math.inf)

    def _grown(
        self, space: Space, hops: Hops, aim: Aim, path: np.ndarray, beams: Beams, most: int
    ) -> list[np.ndarray]:
        """The best few whole ways that go on with a path and that no climb began with."""
        from stimuli.graph.grow_loop import grown

        grown(space, hops, aim, self.random, path, len(path), beams, *self.traces)
        whole = np.isfinite(beams.score[-1])
        found = [
            way[:count].copy()
            for way, count in zip(beams.path[-1, whole], beams.nodes[-1, whole], strict=True)
        ]
        fresh = [way for way in found if way.tobytes() not in self.begun][:most]
        self.begun &= {way.tobytes() for way in found}
        self.begun |= {way.tobytes() for way in fresh}
        return fresh

    def _stand(self, space: Space, aim: Aim, path: np.ndarray) -> tuple[int, float]:
        """The path taken as the one where the crew is: its nodes, 0 for none, and its score."""
        from stimuli.graph.score_loop import score_path

        trace = self.traces[0]
        self.path[: len(path)] = path
        score, used = score_path(
            space, aim, self.path, len(path), aim.frames, math.inf, trace, 0, trace
        )
        return (int(used), float(score)) if math.isfinite(score) else (0, math.inf)

    def _shaken(self, space: Space, aim: Aim, count: int) -> tuple[int, float]:
        """The path with one to three mutations in a row, whatever they cost; 0 nodes for none."""
        from stimuli.graph.score_loop import score_path
        from stimuli.graph.search_loop import mutated
        from stimuli.graph.walk_loop import draw

        new, score, trace = np.empty_like(self.path), math.inf, self.traces[0]
        for _ in range(1 + draw(self.random, 3)):
            for _ in range(SHAKES):
                length, _ = mutated(space, aim, self.random, self.path, count, new)
                if length == 0:
                    continue
                value, used = score_path(
                    space, aim, new, length, aim.frames, math.inf, trace, 0, trace
                )
                if math.isfinite(value):
                    self.path[:used] = new[:used]
                    count, score = used, value
                    break
        return (count, score) if math.isfinite(score) else (0, score)

    def take_up(self, space: Space, aim: Aim, path: np.ndarray) -> float:
        """Climb from a path, and keep it; its score, infinite where it is none."""
        count, score = self._stand(space, aim, path)
        if count:
            self.count, self.score = count, score
            self.keep(space)
        return score

    def keep(self, space: Space) -> None:
        """Keep the path where it is among the best, one for each sequence of clips."""
        path = self.path[: self.count].copy()
        clips = tuple(space.node_to[path].tolist())
        twin = next((answer for answer in self.kept if answer.clips == clips), None)
        if twin is not None:
            if twin.score <= self.score:
                return
            self.kept.remove(twin)
        self.kept.append(KeptPath(path, self.score, clips))
        self.kept.sort(key=lambda answer: answer.score)
        del self.kept[KEPT:]
