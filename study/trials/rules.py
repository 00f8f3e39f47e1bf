"""The staircase rules, by the names that protocols give them; adding one is adding a function."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import NamedTuple

from study.trials.quest import rule_quest
from study.trials.staircase import Rule


class Runs(NamedTuple):
    """How many answers in a row were right, and how many wrong, since the last step."""

    right: int = 0
    wrong: int = 0


def rule_levitt(n_down: int = 2, n_up: int = 1) -> Rule:
    """The transformed up-down rule (Wetherill & Levitt 1965): counters restart after each step.

    With one step up after one wrong answer its target is `½^(1/n_down)`.
    """
    return Rule(
        lambda levels, place: Runs(),
        partial(_step_runs, n_down=n_down, n_up=n_up, down=1.0, up=1.0),
        target_weighted(1.0, 1.0, n_down) if n_up == 1 else None,
    )


def rule_weighted(down: float = 1.0, up: float = 1.0, n_down: int = 1) -> Rule:
    """Weighted up-down (Kaernbach 1991): steps of unequal size, target `target_weighted`."""
    return Rule(
        lambda levels, place: Runs(),
        partial(_step_runs, n_down=n_down, n_up=1, down=down, up=up),
        target_weighted(down, up, n_down),
        finite=float(down).is_integer() and float(up).is_integer(),
    )


def target_weighted(down: float, up: float, n_down: int = 1) -> float:
    """Proportion right at which a weighted staircase settles: `[up/(up+down)]^(1/n_down)`."""
    return float((up / (up + down)) ** (1 / n_down))


def rule_wang() -> Rule:
    """Wang VI.2.1: down when the last two answers were both right, otherwise up.

    Counters never restart, so a first right answer after an error still steps up. Before there
    are two answers the rule holds (ours).
    """
    return Rule(lambda levels, place: None, _step_wang)


RULES: Mapping[str, Callable[..., Rule]] = {
    "levitt": rule_levitt,
    "wang": rule_wang,
    "weighted": rule_weighted,
    "questplus": rule_quest,
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
