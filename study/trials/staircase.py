"""Staircases: from the answers so far, whether the difference shrinks, grows or stays.

A rule is a pair of a first state and a pure step; a track folds answers with it. Nothing else is
remembered, so replaying a record restores a track exactly. Levels are a track's absolute
differences in ascending order; a move is counted in places of that list.
"""

import itertools
from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple


class Rule(NamedTuple):
    """A staircase rule: its first state, and `step(state, correct) -> (state, move)`.

    A move is in places of the level list: negative makes the difference smaller.
    """

    start: Hashable
    step: Callable[[Any, bool], tuple[Hashable, float]]


class Runs(NamedTuple):
    """How many answers in a row were right, and how many wrong, since the last step."""

    right: int = 0
    wrong: int = 0


def rule_levitt(n_down: int = 2, n_up: int = 1) -> Rule:
    """The transformed up-down rule (Wetherill & Levitt 1965): counters restart after each step."""
    return Rule(Runs(), partial(_step_runs, n_down=n_down, n_up=n_up, down=1.0, up=1.0))


def rule_weighted(down: float = 1.0, up: float = 1.0, n_down: int = 1) -> Rule:
    """Weighted up-down (Kaernbach 1991): steps of unequal size, target `target_weighted`."""
    return Rule(Runs(), partial(_step_runs, n_down=n_down, n_up=1, down=down, up=up))


def target_weighted(down: float, up: float, n_down: int = 1) -> float:
    """Proportion right at which a weighted staircase settles: `[up/(up+down)]^(1/n_down)`."""
    return float((up / (up + down)) ** (1 / n_down))


def rule_wang() -> Rule:
    """Wang VI.2.1: down when the last two answers were both right, otherwise up.

    Counters never restart, so a first right answer after an error still steps up. Before there
    are two answers the rule holds (ours).
    """
    return Rule(None, _step_wang)


RULES: Mapping[str, Callable[..., Rule]] = {
    "levitt": rule_levitt,
    "wang": rule_wang,
    "weighted": rule_weighted,
}


def _step_runs(
    runs: Runs, correct: bool, n_down: int, n_up: int, down: float, up: float
) -> tuple[Runs, float]:
    runs = Runs(runs.right + 1, 0) if correct else Runs(0, runs.wrong + 1)
    if runs.right == n_down:
        return Runs(), -down
    if runs.wrong == n_up:
        return Runs(), up
    return runs, 0.0


def _step_wang(last: bool | None, correct: bool) -> tuple[bool, float]:
    if last is None:
        return correct, 0.0
    return correct, -1.0 if last and correct else 1.0


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
    """Conditions (name, n) of which any or all must hold for a track to end."""

    conditions: tuple[tuple[str, int], ...]
    combine: Callable[[Iterable[bool]], bool] = any

    def reason(self, track: Track) -> str | None:
        """The conditions that ended the track, or None while it goes on."""
        held = [STOPS[name](n, track) for name, n in self.conditions]
        if not self.combine(held):
            return None
        return " and ".join(
            f"{name} {n}" for (name, n), holds in zip(self.conditions, held, strict=True) if holds
        )


def start_track(name: str, levels: Iterable[int], rule: Rule, stop: Stop) -> Track:
    """A track before its first answer; it starts at its largest difference.

    Raises ValueError when `levels` is empty, not ascending, or holds a level below 1.
    """
    ordered = tuple(levels)
    if not ordered or ordered[0] < 1 or any(b <= a for a, b in itertools.pairwise(ordered)):
        raise ValueError(f"track {name}: expected ascending levels from 1 up, found {ordered}")
    return Track(name, ordered, rule, stop, float(len(ordered) - 1), rule.start)


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
