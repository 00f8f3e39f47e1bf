"""Natural: one clip; is it natural or not (Ikemoto et al. 2007, 4: labels that train a score)?"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import Field
from scipy.special import expit, logit

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

NATURAL, UNNATURAL = "natural", "unnatural"


class NaturalObserver(ObserverTable):
    """The probability of calling a clip of each method natural; `spread` is in log odds."""

    natural: dict[str, Share] = Field(default_factory=dict)


class NaturalFile(ProtocolFile):
    """A protocol of this task."""

    observer: NaturalObserver | None = None


@dataclass(frozen=True)
class OneClip:
    """One transition joined by one method."""

    motion: str
    method: str


def start(plan: Plan) -> Supply:
    """Every clip once in each repeat, shuffled."""
    methods = plan.protocol.file.methods
    items = [(motion.name, method) for motion in plan.motions for method in methods]
    repeats = 1 if plan.rehearsal else plan.protocol.file.trials.repeats
    return shuffled([items] * repeats, plan.generator(0))


def content(plan: Plan, card: Card, generator: np.random.Generator) -> OneClip:
    """The trial for a card."""
    return OneClip(*map(str, card.item))


def practice(plan: Plan, generator: np.random.Generator) -> Card:
    """A card drawn at random from all of them."""
    motion = plan.motions[int(generator.integers(len(plan.motions)))]
    methods = plan.protocol.file.methods
    return Card((motion.name, methods[int(generator.integers(len(methods)))]))


def screens(trial: OneClip) -> Screens:
    """The clip alone."""
    return (clips(trial),)


def clips(trial: OneClip) -> tuple[ClipKey, ...]:
    """`clip_a` is the clip; there is no other."""
    return (ClipKey(trial.motion, method=trial.method),)


def correct(trial: OneClip, response: str | None) -> bool | None:
    """A judgement has no right answer."""
    return None


def row(trial: OneClip, outcome: Outcome) -> dict[str, object]:
    """The task's own columns of the record."""
    return {"motion": trial.motion, "clip": clips(trial)[0]}


def person(plan: Plan, truth: NaturalObserver, generator: np.random.Generator) -> Responder:
    """A person who finds clips natural by the protocol's odds, shifted by SD `spread`."""
    shift = truth.spread * generator.standard_normal()

    def respond(trial: OneClip, draw: np.random.Generator) -> str:
        share = float(expit(logit(truth.natural[trial.method]) + shift))
        return NATURAL if draw.random() < share else UNNATURAL

    return respond


def holds(file: ProtocolFile, truth: NaturalObserver) -> Iterator[Held]:
    """The share of each method's clips that is called natural."""
    for method, share in truth.natural.items():

        def told(row: Mapping[str, Any], method: str = method) -> float | None:
            of_it = str(row["clip"]).endswith(f"/{method}")  # as a clip of no set is called
            return float(row["response"] == NATURAL) if of_it else None

        yield Held(f"{NATURAL}, {method}", share, told)


def faults(document: Mapping[str, Any]) -> Iterator[Fault]:
    """What is wrong with a protocol of this task beyond single keys."""
    yield from no_conditions(document)
    yield from no_right_answers(document)
    yield from no_lengths(document, "a study of naturalness shows methods")
    methods = set(map(str, given_methods(document)))
    if not methods:
        yield Fault(("methods",), "expected the methods whose clips are shown, found none")
    if table_at(document, "observer"):
        shares = table_at(document, "observer", "natural")
        if set(shares) != methods:
            message = f"expected a probability for each of {sorted(methods)}, found {dict(shares)}"
            yield Fault(("observer", "natural"), message)


_QUESTION = "Was the motion natural?\n\n{first}   natural\n{second}   not natural"

TASK = Task(
    name="natural",
    layout="one-after-other",
    welcome=(
        "You will see short animations, one at a time.\n\n"
        "Was the motion natural, as a person would move? "
        "Press {first} if it was, {second} if it was not.\n\nPress {go_on} to begin."
    ),
    columns={
        "motion": "the transition shown",
        "clip": "hash of the clip shown",
    },
    analysis="naturalness",
    file=NaturalFile,
    faults=faults,
    start=start,
    content=content,
    practice=practice,
    catch=None,
    screens=screens,
    clips=clips,
    ask=alternatives(_QUESTION, NATURAL, UNNATURAL),
    correct=correct,
    row=row,
    person=person,
    holds=holds,
)
