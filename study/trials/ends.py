"""How often tracks end at the first or last level of a design, for whom, and what would mend it.

A track that ends there says only that a threshold lies beyond, or near, what was shown. Tracks of
people with known proportions right are run here many at once, through the rule's own states.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from analysis.psychometric.functions import Array
from study.trials.chain import reachable
from study.trials.staircase import Track, answer, start_track

TRACKS = 2000  # of a rule whose states are few
SLOW_TRACKS = 100  # of a rule that has to be run answer by answer
PEOPLE = (-2.0, -1.0, 0.0, 1.0, 2.0)  # SDs of the personal thresholds that are told one by one
SELDOM = 0.05  # the share of tracks at an end below which a change mends it
MORE_LEVELS = 4  # of levels that are tried beyond an end


@dataclass(frozen=True)
class Observers:
    """The people of a side: mean and SD of their thresholds, the least of them, and their
    proportion right (L,) at ascending levels (L,) for a threshold."""

    mean: float
    spread: float
    least: float
    right: Callable[[float, Array], Array]

    def thresholds(self, count: int) -> Array:
        """Thresholds of `count` people that stand for all, by quantiles of the normal."""
        scores = norm.ppf((np.arange(count) + 0.5) / count)
        return np.maximum(self.mean + self.spread * scores, self.least)

    def proportions(self, thresholds: Array, levels: Sequence[int]) -> Array:
        """(N, L) proportions right."""
        shown, distinct = np.asarray(levels, float), np.unique(thresholds)
        each = {float(t): self.right(float(t), shown) for t in distinct}
        return np.array([each[float(t)] for t in thresholds])


def ends_of(
    name: str, track: Track, observers: Observers, room: int | None, generator: np.random.Generator
) -> dict[str, Any]:
    """Shares of a track's ends: of all people, by personal threshold, and after changes.

    `room` is the largest level that there can be, None where there is no such.
    """
    seed = int(generator.integers(2**32))  # every variant meets the same luck

    def shares(variant: Track, thresholds: Array) -> tuple[float, float]:
        places = ended(variant, observers.proportions(thresholds, variant.levels),
                       np.random.default_rng(seed))  # fmt: skip
        return float(np.mean(places == 0)), float(np.mean(places == len(variant.levels) - 1))

    count = TRACKS if track.rule.finite else SLOW_TRACKS
    everybody = observers.thresholds(count)
    first, last = shares(track, everybody)
    scores = PEOPLE if observers.spread else (0.0,)
    people = [max(observers.mean + score * observers.spread, observers.least) for score in scores]
    told = [(t, *shares(track, np.full(count, t))) for t in people]
    changes = [
        {"change": what, "start": variant.level, "levels": list(variant.levels),
         "at_ends": sum(shares(variant, everybody))}
        for what, variant in variants(track, room)
    ]  # fmt: skip
    return {
        "track": name,
        "levels": list(track.levels),
        "start": track.level,
        "ends_first": first,
        "ends_last": last,
        "people": [{"threshold": t, "ends_first": a, "ends_last": b} for t, a, b in told],
        "changes": sorted(changes, key=lambda change: float(str(change["at_ends"]))),
    }


def variants(track: Track, room: int | None) -> Iterator[tuple[str, Track]]:
    """A track with other starts, and with levels more at either end."""
    levels = track.levels
    for level in levels:
        if level != track.level:
            yield f"start = {level}", _again(track, levels, level)
    if len(levels) < 2:
        return
    up, down = levels[-1] - levels[-2], levels[1] - levels[0]
    for more in range(1, MORE_LEVELS + 1):
        beyond = tuple(levels[-1] + up * n for n in range(1, more + 1))
        below = tuple(levels[0] - down * n for n in range(more, 0, -1))
        if room is None or beyond[-1] <= room:
            yield f"levels to {beyond[-1]}", _again(track, (*levels, *beyond), track.level)
        if below[0] >= 1:
            yield f"levels from {below[0]}", _again(track, (*below, *levels), track.level)


def _again(track: Track, levels: tuple[int, ...], start: int) -> Track:
    return start_track(track.name, levels, track.rule, track.stop, start)


def ended(track: Track, right: Array, generator: np.random.Generator) -> NDArray[np.int64]:
    """The places (N,) of the levels at which tracks end, of people right (N, L) at each level."""
    draws = generator.random((track.stop.most, len(right)))
    if not track.rule.finite:
        return np.array([_fold(track, p, draws[:, n]) for n, p in enumerate(right)])
    return _together(track, right, draws)


def _fold(track: Track, right: Array, draws: Array) -> int:
    """The place where one track ends, answer by answer."""
    for draw in draws:
        track = answer(track, bool(draw < right[track.levels.index(track.level)]))
        if track.stopped_by is not None:
            break
    return track.levels.index(track.answers[-1][0])


def _together(track: Track, right: Array, draws: Array) -> NDArray[np.int64]:
    """The same of N tracks at once, over the rule's states."""
    states = reachable(track.rule, track.state)
    index = {state: n for n, state in enumerate(states)}
    steps = [[track.rule.step(state, bool(found)) for found in (0, 1)] for state in states]
    after = np.array([[index[state] for state, _ in pair] for pair in steps])
    moves = np.array([[move for _, move in pair] for pair in steps], float)
    count, top = len(right), len(track.levels) - 1.0
    everyone = np.arange(count)
    state, position = np.full(count, index[track.state]), np.full(count, track.position)
    last, turned = np.zeros(count), np.zeros(count, int)
    visits, finished = np.zeros((count, len(track.levels)), int), np.full(count, -1)
    for trial, draw in enumerate(draws, start=1):
        shown = (position + 0.5).astype(int)
        visits[everyone, shown] += 1
        found = (draw < right[everyone, shown]).astype(int)
        moved = np.clip(position + moves[state, found], 0.0, top) - position
        turned += moved * last < 0
        last = np.where(moved == 0, last, moved)
        position, state = position + moved, after[state, found]
        held = {"visits": visits.max(1), "reversals": turned, "trials": np.full(count, trial)}
        met = [held[name] >= n for name, n in track.stop.conditions]
        stopped = np.all(met, 0) if track.stop.combine is all else np.any(met, 0)
        over = (stopped | (trial >= track.stop.most)) & (finished < 0)
        finished[over] = shown[over]
        if (finished >= 0).all():
            break
    return finished
