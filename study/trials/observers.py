"""Simulated observers: participants whose truth stands in the protocol, answering its trials.

What a person of a study is, and how they answer, is the task's own (see `study.trials.tasks`).
"""

from dataclasses import dataclass

import numpy as np

from stimuli.errors import InputError
from study.trials.plan import Plan
from study.trials.tasks import TASKS, Responder

MEDIAN_RESPONSE_SECONDS = 0.7
RESPONSE_LOG_SD = 0.35


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
    return Simulated(TASKS[plan.protocol.file.task].person(plan, truth, plan.generator(2)))
