"""Staircases: from the answers so far, whether the difference shrinks, grows or stays.

A rule (see `study.trials.rules`) gives a first state and a pure step; a track folds answers with
it. Nothing else is remembered, so replaying a record restores a track exactly. Levels are a track's
absolute differences in ascending order; a move is counted in places of that list.
"""

import itertools
from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

MOST_TRIALS = 200  # of a track where a protocol states no other number: who is always right or
# always wrong never reverses


class Rule(NamedTuple):
    """A staircase rule: its first state on levels at a place, and a step `-> (state, move)`.

    A move is in places of the level list: negative makes the difference smaller. `target` is the
    proportion right at which the rule settles by its formula, None where it has none; `finite`
    says that answers lead to a finite number of states, so that the rule has an exact chain.
    """

    begin: Callable[[tuple[int, ...], int], Hashable]
    step: Callable[[Any, bool], tuple[Hashable, float]]
    target: float | None = None
    finite: bool = True


@dataclass(frozen=True)
class Track:
    """One staircase over `levels`, with what the answers so far have made of it."""

    name: str
    levels: tuple[int, ...]
    rule: Rule
    stop: "Stop"
    position: float
    state: Hashable
    answers: tuple[tuple[int, bool], ...] = ()
    reversals: tuple[int, ...] = ()
    last_move: float = 0.0
    stopped_by: str | None = None

    @property
    def level(self) -> int:
        """The difference to show next: the level nearest the position (halves toward larger)."""
        return self.levels[int(self.position + 0.5)]

    @property
    def visits(self) -> Counter[int]:
        """How often each level has been answered."""
        return Counter(level for level, _ in self.answers)

    @property
    def ended_at_edge(self) -> bool:
        """Whether a finished track ended at its first or last level."""
        last = self.answers[-1][0] if self.answers else None
        return self.stopped_by is not None and last in (self.levels[0], self.levels[-1])


def stop_visits(n: int, track: Track) -> bool:
    """Any level has been answered `n` times (Wang VI.3: ten)."""
    return max(track.visits.values()) >= n


def stop_reversals(n: int, track: Track) -> bool:
    """The track has turned `n` times."""
    return len(track.reversals) >= n


def stop_trials(n: int, track: Track) -> bool:
    """The track has `n` answers."""
    return len(track.answers) >= n


STOPS: Mapping[str, Callable[[int, Track], bool]] = {
    "visits": stop_visits,
    "reversals": stop_reversals,
    "trials": stop_trials,
}


@dataclass(frozen=True)
class Stop:
    """Conditions (name, n) of which any or all must hold for a track to end.

    Whatever they are, it ends after `most` answers, and says that this ended it.
    """

    conditions: tuple[tuple[str, int], ...]
    combine: Callable[[Iterable[bool]], bool] = any
    most: int = MOST_TRIALS

    def reason(self, track: Track) -> str | None:
        """The conditions that ended the track, or None while it goes on."""
        held = [STOPS[name](n, track) for name, n in self.conditions]
        if not self.combine(held):
            return f"most {self.most}" if len(track.answers) >= self.most else None
        return " and ".join(
            f"{name} {n}" for (name, n), holds in zip(self.conditions, held, strict=True) if holds
        )


def start_track(
    name: str, levels: Iterable[int], rule: Rule, stop: Stop, start: int | None = None
) -> Track:
    """A track before its first answer, at the level nearest `start`, else at its largest.

    Raises ValueError when `levels` is empty, not ascending, or holds a level below 1.
    """
    ordered = tuple(levels)
    if not ordered or ordered[0] < 1 or any(b <= a for a, b in itertools.pairwise(ordered)):
        raise ValueError(f"track {name}: expected ascending levels from 1 up, found {ordered}")
    first = len(ordered) - 1
    if start is not None:
        first = min(range(len(ordered)), key=lambda place: (abs(ordered[place] - start), -place))
    return Track(name, ordered, rule, stop, float(first), rule.begin(ordered, first))


def answer(track: Track, correct: bool) -> Track:
    """The track after one more answer at its present level.

    At an end the track stays, and a stay is no reversal.
    """
    if track.stopped_by is not None:
        raise ValueError(f"track {track.name} has ended ({track.stopped_by}); no answer belongs")
    state, move = track.rule.step(track.state, correct)
    position = min(max(track.position + move, 0.0), len(track.levels) - 1.0)
    moved = position - track.position
    turned = moved * track.last_move < 0
    after = replace(
        track,
        position=position,
        state=state,
        answers=(*track.answers, (track.level, correct)),
        reversals=(*track.reversals, track.level) if turned else track.reversals,
        last_move=moved or track.last_move,
    )
    return replace(after, stopped_by=track.stop.reason(after))


def replay_track(track: Track, answers: Iterable[bool]) -> Track:
    """Fold a sequence of answers into a track."""
    for correct in answers:
        track = answer(track, correct)
    return track
