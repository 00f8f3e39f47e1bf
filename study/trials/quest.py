"""QUEST+ (Watson 2017) as a staircase rule, by the questplus library.

After each answer the next level is the one whose answer is expected to tell most of the threshold:
the least expected entropy of the posterior over thresholds and slopes of a Weibull function on the
logarithm of the level.
"""

from functools import lru_cache, partial
from typing import Any, NamedTuple

import numpy as np

from study.trials.staircase import Rule

GUESS = 0.5  # of two alternatives
_GRID, BEYOND = 41, 0.3  # a grid in log10 frames, from a half of the least level to twice the
# largest
SLOPES = tuple(float(s) for s in np.geomspace(0.5, 8.0, 9))  # of the Weibull
_RIGHT, _WRONG = "right", "wrong"  # the answer that counts as success comes first: it goes by place


class Grid(NamedTuple):
    """What a posterior is over: levels and the parameters of `function`, all in its `scale`."""

    levels: tuple[float, ...]
    thresholds: tuple[float, ...]
    slopes: tuple[float, ...]
    guess: float
    lapse: float
    function: str = "weibull"
    scale: str = "log10"


class Asked(NamedTuple):
    """The state of the rule: what was asked (places of levels) and answered, the place now."""

    grid: Grid
    answers: tuple[tuple[int, bool], ...]
    place: int


def rule_quest(lapse: float = 0.02) -> Rule:
    """QUEST+ over a track's levels; `lapse` is the rate that its function takes for known.

    A track begins where every other does, and goes where the posterior says from then on.
    """
    return Rule(partial(_begin, lapse=lapse), _step, finite=False)


def _begin(levels: tuple[int, ...], place: int, lapse: float) -> Asked:
    logs = np.log10(np.asarray(levels, dtype=float))
    grid = Grid(
        levels=tuple(map(float, logs)),
        thresholds=tuple(map(float, np.linspace(logs[0] - BEYOND, logs[-1] + BEYOND, _GRID))),
        slopes=SLOPES,
        guess=GUESS,
        lapse=lapse,
    )
    return Asked(grid, (), place)


def _step(asked: Asked, correct: bool) -> tuple[Asked, float]:
    answers = (*asked.answers, (asked.place, correct))
    place = best_place(asked.grid, answers)
    return Asked(asked.grid, answers, place), float(place - asked.place)


def best_place(grid: Grid, answers: tuple[tuple[int, bool], ...]) -> int:
    """The place of the level to ask next, after these answers (place, right)."""
    level = _posterior(grid, answers).next_stim["intensity"]
    return int(np.argmin(np.abs(np.asarray(grid.levels) - level)))


@lru_cache(maxsize=512)
def _posterior(grid: Grid, answers: tuple[tuple[int, bool], ...]) -> Any:
    """The library's posterior after these answers, from that before the last of them."""
    if not answers:
        return _prior(grid)
    from copy import copy

    before = _posterior(grid, answers[:-1])
    after = copy(before)
    after.stim_history, after.resp_history = [*before.stim_history], [*before.resp_history]
    place, right = answers[-1]
    after.update(
        stim={"intensity": grid.levels[place]}, outcome={"response": _RIGHT if right else _WRONG}
    )
    return after


def _prior(grid: Grid) -> Any:
    from questplus import QuestPlus

    return QuestPlus(
        stim_domain={"intensity": np.asarray(grid.levels)},
        param_domain={
            "threshold": np.asarray(grid.thresholds),
            "slope": np.asarray(grid.slopes),
            "lower_asymptote": np.asarray([grid.guess]),
            "lapse_rate": np.asarray([grid.lapse]),
        },
        outcome_domain={"response": [_RIGHT, _WRONG]},
        func=grid.function,
        stim_scale=grid.scale,
    )
