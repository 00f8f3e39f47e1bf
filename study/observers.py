"""Simulated observers: what a participant truly is, answering trials with it.

For odd pairs the proportion right at a difference d is a psychometric function of |d| whose
thresholds are personal, drawn around the protocol's; for preferences each method has a
probability of being chosen, shifted in log odds for a person.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from analysis.psychometric import location_for, proportion
from stimuli.errors import InputError
from study.plan import Plan
from study.schema import Observer
from study.tasks.odd_pair import OddPair
from study.tasks.preference import Preference

SMALLEST_THRESHOLD = 0.5
MEDIAN_RESPONSE_SECONDS = 0.7
RESPONSE_LOG_SD = 0.35

Responder = Callable[[Any, np.random.Generator], str]


@dataclass(frozen=True)
class Simulated:
    """A simulated participant: `answer(content, generator)` gives a response and seconds."""

    respond: Responder

    def answer(self, content: object, generator: np.random.Generator) -> tuple[str, float]:
        """The response to a trial's content and the seconds it took."""
        response = self.respond(content, generator)
        noise = RESPONSE_LOG_SD * generator.standard_normal()
        return response, float(MEDIAN_RESPONSE_SECONDS * np.exp(noise))


def simulated(plan: Plan) -> Simulated:
    """The participant of this plan's seed; raises InputError without a table [observer]."""
    truth = plan.protocol.file.observer
    if truth is None:
        raise InputError(
            f"{plan.protocol.name}: expected a table [observer] that says what a simulated "
            "participant truly is, found none; add it"
        )
    return Simulated(PERSONS[plan.protocol.file.task](plan, truth, plan.generator(2)))


def person_odd_pair(plan: Plan, truth: Observer, generator: np.random.Generator) -> Responder:
    """A person whose personal thresholds lie around the protocol's with SD `spread` (frames)."""
    assert truth.slope is not None
    slope, locations = truth.slope, {}
    for side, mean in (("shorter", truth.shorter), ("longer", truth.longer)):
        deviation = truth.spread * generator.standard_normal()
        if mean is not None:
            threshold = max(abs(mean) + deviation, SMALLEST_THRESHOLD)
            locations[side] = location_for(
                truth.function, threshold, truth.at, slope, 0.5, truth.lapse
            )

    def respond(trial: OddPair, draw: np.random.Generator) -> str:
        level = abs(trial.difference)
        location = locations[trial.track]
        right = proportion(truth.function, level, location, slope, 0.5, truth.lapse)
        correct = draw.random() < float(right)
        return str(trial.odd_pair if correct else 3 - trial.odd_pair)

    return respond


def person_preference(plan: Plan, truth: Observer, generator: np.random.Generator) -> Responder:
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


def _shares(prefer: Mapping[str, Any], category: str) -> Mapping[str, float]:
    nested = prefer.get(category)
    return nested if isinstance(nested, Mapping) else prefer


def _odds(first: float, second: float) -> float:
    tiny = 1e-12
    return max(first, tiny) / max(second, tiny)


PERSONS: Mapping[str, Callable[[Plan, Observer, np.random.Generator], Responder]] = {
    "odd-pair": person_odd_pair,
    "preference": person_preference,
}
