"""Preference: two clips of one transition; which is more natural (Wang V.2)?"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from study.deck import Card, Source, shuffled
from study.plan import Plan
from study.tasks.task import Screens, Task
from study.trial import ClipKey, Outcome


@dataclass(frozen=True)
class Preference:
    """One transition joined by two methods, in the order shown."""

    motion: str
    category: str
    first_method: str
    second_method: str


def start(plan: Plan) -> Source:
    """Every motion with every pair of methods, shuffled in each repeat.

    Balanced orders put the first-named method first in half of all trials, drawn by the seed.
    """
    table = plan.protocol.file.trials
    pairs = list(combinations(plan.protocol.file.methods, 2))
    generator = plan.generator(0)
    repeats = 1 if plan.rehearsal else table.repeats
    items = [(m.name, *pair) for _ in range(repeats) for m in plan.motions for pair in pairs]
    if table.first == "balanced":
        swap = generator.permutation(np.arange(len(items)) + generator.integers(2)) % 2 == 1
    else:
        swap = generator.integers(2, size=len(items)) == 1
    ordered = [
        (name, b, a) if swapped else (name, a, b)
        for (name, a, b), swapped in zip(items, swap, strict=True)
    ]
    size = len(items) // repeats
    return shuffled([ordered[n : n + size] for n in range(0, len(items), size)], generator)


def content(plan: Plan, card: Card, generator: np.random.Generator) -> Preference:
    """The trial for a card, whose order was drawn with the deck."""
    name, first, second = card.item
    motion = next(m for m in plan.motions if m.name == name)
    return Preference(motion.name, motion.category, str(first), str(second))


def practice(plan: Plan, generator: np.random.Generator) -> Card:
    """A card drawn at random from all of them."""
    first, second = generator.permutation(np.array(plan.protocol.file.methods))[:2]
    motion = plan.motions[int(generator.integers(len(plan.motions)))]
    return Card((motion.name, str(first), str(second)))


def screens(trial: Preference) -> Screens:
    """The first clip, then the second."""
    first, second = clips(trial)
    return ((first,), (second,))


def clips(trial: Preference) -> tuple[ClipKey, ClipKey]:
    """`clip_a` is the clip shown first, `clip_b` the second."""
    return (
        ClipKey(trial.motion, method=trial.first_method),
        ClipKey(trial.motion, method=trial.second_method),
    )


def correct(trial: Preference, response: str | None) -> bool | None:
    """A preference has no right answer."""
    return None


def row(trial: Preference, outcome: Outcome) -> dict[str, object]:
    """The task's own columns of the record."""
    chosen = {"first": trial.first_method, "second": trial.second_method, None: None}
    return {
        "motion": trial.motion,
        "category": trial.category or None,
        "first_method": trial.first_method,
        "second_method": trial.second_method,
        "chosen_method": chosen[outcome.response],
    }


TASK = Task(
    name="preference",
    responses=("first", "second"),
    layout="one-after-other",
    question="Which motion was more natural?\n\n{first}   the first        {second}   the second",
    welcome=(
        "You will see two short animations, one after the other.\n\n"
        "Which one was more natural? Press {first} for the first, {second} for the second.\n"
        "You have {seconds:g} seconds to answer.\n\nPress {go_on} to begin."
    ),
    columns={
        "motion": "the transition shown",
        "category": "the kind of motion",
        "first_method": "the method of the clip shown first (left when side by side)",
        "second_method": "the method of the clip shown second",
        "chosen_method": "the method of the clip judged more natural",
    },
    start=start,
    content=content,
    practice=practice,
    catch=None,
    screens=screens,
    clips=clips,
    correct=correct,
    row=row,
    answer_seconds=5.0,
)
