"""Where a session stands: practice, then main trials with catch trials among them.

A pure fold: `next_trial` says what to show, `advance` takes what came of it. Replaying the rows
of a record therefore restores a session exactly. Every trial draws from a generator of its own,
keyed by the session's seed and the trial's number.
"""

from dataclasses import dataclass, replace

import numpy as np

from study.trials.deck import Card, Supply
from study.trials.plan import Plan
from study.trials.tasks import TASKS, Task
from study.trials.trial import Outcome, Trial

MOST_REPEATS = 2
REPEATED_SHARE = 0.1
FIRST_VOIDS = 2
PRACTICE_BLOCKS = 3  # where a protocol has a criterion and no most


@dataclass(frozen=True, eq=False)
class Progress:
    """Counts so far, and the supply of the main trials."""

    plan: Plan
    task: Task
    supply: Supply
    number: int = 0
    practice: tuple[bool, ...] = ()  # whether each practice trial was answered right
    answered: int = 0
    voided: int = 0
    caught: int = 0
    caught_right: int = 0


def begin(plan: Plan) -> Progress:
    """A session before its first trial."""
    task = TASKS[plan.protocol.file.task]
    return Progress(plan, task, task.start(plan))


def next_trial(progress: Progress) -> tuple[Trial, Card] | None:
    """The trial to show now and its card, or None when the session is over."""
    plan, task = progress.plan, progress.task
    number = progress.number + 1
    generator = plan.generator(1, number)
    phase, card = _draw(progress, generator)
    if card is None:
        return None
    content = task.content(plan, card, generator)
    return Trial(number, phase, content, card.repeat_of), card


def _draw(progress: Progress, generator: np.random.Generator) -> tuple[str, Card | None]:
    table, task = progress.plan.protocol.file.trials, progress.task
    if task.practice and _practises(progress):
        return "practice", task.practice(progress.plan, generator)
    card = progress.supply.draw(generator)
    due = table.catch_every and progress.answered // table.catch_every > progress.caught
    if card is not None and task.catch and due:
        return "catch", task.catch(progress.plan, generator)
    return "main", card


def _practises(progress: Progress) -> bool:
    """Whether a practice trial is next: all of a block, then more until the criterion is met."""
    table, done = progress.plan.protocol.file.trials, len(progress.practice)
    if progress.plan.rehearsal or not table.practice:
        return False
    most = table.practice_most or PRACTICE_BLOCKS * table.practice
    return done < table.practice or (done < most and not practised_enough(progress))


def practised_enough(progress: Progress) -> bool:
    """Whether the last block of practice was right as often as the protocol wants."""
    table = progress.plan.protocol.file.trials
    if table.practice_criterion is None:
        return True
    last = progress.practice[-table.practice :]
    return sum(last) >= table.practice_criterion * len(last)


def may_void(progress: Progress, trial: Trial, card: Card) -> bool:
    """Whether this trial may be asked again: at most twice, and a tenth of all trials so far.

    The first FIRST_VOIDS are always asked again, or a session could not begin with a late trial.
    """
    allowed = max(FIRST_VOIDS, REPEATED_SHARE * (progress.answered + 1))
    return trial.phase == "main" and card.times < MOST_REPEATS and progress.voided < allowed


def advance(progress: Progress, trial: Trial, card: Card, outcome: Outcome) -> Progress:
    """The session after one trial."""
    after = replace(progress, number=trial.number)
    right = after.task.correct(trial.content, outcome.response)
    if trial.phase == "practice":
        return replace(after, practice=(*after.practice, bool(right)))
    if trial.phase == "catch":
        caught_right = after.caught_right + bool(right)
        return replace(after, caught=after.caught + 1, caught_right=caught_right)
    if outcome.void:
        supply = after.supply.void(card, trial.number)
        return replace(after, supply=supply, voided=after.voided + 1)
    return replace(after, supply=after.supply.answered(card, right), answered=after.answered + 1)


def pause_due(before: Progress, after: Progress) -> bool:
    """Whether a break comes after the trial that led from `before` to `after`."""
    every = after.plan.protocol.file.trials.break_every
    return bool(every and after.answered > before.answered and after.answered % every == 0)
