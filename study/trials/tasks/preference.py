"""Preference: two clips of one transition; which is more natural (Wang V.2)?"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from pydantic import Field

from study.protocol.faults import (
    Fault,
    given_methods,
    no_conditions,
    no_lengths,
    no_right_answers,
    table_at,
)
from study.protocol.schema import ObserverTable, ProtocolFile, Share
from study.trials.deck import Card, Supply, shuffled
from study.trials.plan import Plan
from study.trials.tasks.task import Held, Responder, Screens, Task, alternatives
from study.trials.trial import ClipKey, Outcome

_TINY = 1e-12  # stands for a probability of 0 in odds


class PreferenceObserver(ObserverTable):
    """The probability of choosing each method over its rival, for all or by category."""

    prefer: dict[str, Share | dict[str, Share]] = Field(default_factory=dict)


class PreferenceFile(ProtocolFile):
    """A protocol of this task."""

    observer: PreferenceObserver | None = None


@dataclass(frozen=True)
class Preference:
    """One transition joined by two methods, in the order shown."""

    motion: str
    category: str
    first_method: str
    second_method: str


def start(plan: Plan) -> Supply:
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


def person(plan: Plan, truth: PreferenceObserver, generator: np.random.Generator) -> Responder:
    """A person who prefers methods by the protocol's odds, shifted by SD `spread` in log odds."""
    first_named = plan.protocol.file.methods[0]
    shift = truth.spread * generator.standard_normal()

    def respond(trial: Preference, draw: np.random.Generator) -> str:
        shares = _shares(truth.prefer, trial.category)
        odds = np.log(_odds(shares[trial.first_method], shares[trial.second_method]))
        if first_named in (trial.first_method, trial.second_method):
            odds += shift if trial.first_method == first_named else -shift
        chosen_first = draw.random() < 1 / (1 + np.exp(-odds))
        return "first" if chosen_first else "second"

    return respond


def holds(file: ProtocolFile, truth: PreferenceObserver) -> Iterator[Held]:
    """Of each two methods the share of answers for the first, by category where that decides."""
    nested = {name: held for name, held in truth.prefer.items() if isinstance(held, Mapping)}
    for category in list(nested) or [""]:
        shares = _shares(truth.prefer, category)
        for a, b in combinations(file.methods, 2):

            def told(
                row: Mapping[str, Any], pair: frozenset[str] = frozenset((a, b)), a: str = a,
                category: str = category,
            ) -> float | None:  # fmt: skip
                of_them = {row["first_method"], row["second_method"]} == pair
                if not of_them or category not in ("", row["category"]):
                    return None
                return float(row["chosen_method"] == a) if row["chosen_method"] in pair else None

            odds = _odds(shares[a], shares[b])
            yield Held(f"{a} over {b}{category and f', {category}'}", odds / (1 + odds), told)


def _shares(prefer: Mapping[str, Any], category: str) -> Mapping[str, float]:
    nested = prefer.get(category)
    return nested if isinstance(nested, Mapping) else prefer


def _odds(first: float, second: float) -> float:
    return max(first, _TINY) / max(second, _TINY)


def faults(document: Mapping[str, Any]) -> Iterator[Fault]:
    """What is wrong with a preference protocol beyond single keys."""
    yield from no_conditions(document)
    methods = given_methods(document)
    yield from no_right_answers(document)
    yield from no_lengths(document, "a preference study compares methods")
    if len(set(map(str, methods))) < 2:
        yield Fault(("methods",), f"expected two or more methods to compare, found {methods}")
    if not table_at(document, "observer"):
        return
    wanted = set(map(str, methods))
    prefer = table_at(document, "observer", "prefer")
    nested = {k: v for k, v in prefer.items() if isinstance(v, Mapping)} or {"": prefer}
    for category, shares in nested.items():
        path = ("observer", "prefer", category) if category else ("observer", "prefer")
        if set(shares) != wanted:
            message = f"expected a probability for each of {sorted(wanted)}, found {dict(shares)}"
            yield Fault(path, message)


_QUESTION = "Which motion was more natural?\n\n{first}   the first\n{second}   the second"

TASK = Task(
    name="preference",
    layout="one-after-other",
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
    analysis="preferences",
    file=PreferenceFile,
    faults=faults,
    start=start,
    content=content,
    practice=practice,
    catch=None,
    screens=screens,
    clips=clips,
    ask=alternatives(_QUESTION, "first", "second"),
    correct=correct,
    row=row,
    person=person,
    holds=holds,
    answer_seconds=5.0,
)
