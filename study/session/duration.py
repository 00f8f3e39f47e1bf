"""How many trials a session has and about how long it takes, from sessions that are simulated."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from study.protocol.protocol import Protocol
from study.session.simulation import rows
from study.trials.observers import Responder, Simulated, simulated
from study.trials.plan import Plan, make_plan
from study.trials.tasks import TASKS

SESSIONS = 5
SHARE_RIGHT = 0.75  # of a participant of whom the protocol says nothing


@dataclass(frozen=True)
class Duration:
    """The fewest and most trials of the simulated sessions, and their mean minutes."""

    least: int
    most: int
    minutes: float

    @property
    def trials(self) -> int:
        """About how many trials, practice included."""
        return round((self.least + self.most) / 2)

    def told(self, pace: float = 1.0) -> str:
        """The duration as a sentence."""
        about = "" if self.least == self.most else "about "
        trials = f"{about}{self.trials} {'trial' if self.trials == 1 else 'trials'}"
        whole = round(self.minutes / pace)
        minutes = {0: "less than a minute", 1: "about a minute"}.get(
            whole, f"about {whole} minutes"
        )
        return f"a session has {trials} and takes {minutes}"


def session_duration(
    protocol: Protocol, references: dict[str, int], rehearsal: bool = False
) -> Duration:
    """Trials and minutes of sessions of this protocol; breaks count for nothing."""
    plans = [make_plan(protocol, references, seed, rehearsal) for seed in range(SESSIONS)]
    tables = [[row["onset"] for row in rows(plan, _participant(plan))] for plan in plans]
    counts = [len(table) for table in tables]
    return Duration(min(counts), max(counts), float(np.mean([minutes_of(t) for t in tables])))


def minutes_of(onsets: Sequence[float]) -> float:
    """Minutes of a session whose last trial lasts as long as the others on average."""
    span = onsets[-1] - onsets[0]
    return (span + span / max(len(onsets) - 1, 1)) / 60


def _participant(plan: Plan) -> Simulated:
    return simulated(plan) if plan.protocol.file.observer else Simulated(_somebody(plan))


def _somebody(plan: Plan) -> Responder:
    """Right in SHARE_RIGHT of the trials that have a right answer."""
    task = TASKS[plan.protocol.file.task]

    def respond(content: object, draw: np.random.Generator) -> str:
        responses = task.ask(plan.protocol.file, content).answers.values()
        ordered = sorted(responses, key=lambda answer: not task.correct(content, answer))
        return ordered[int(draw.random() >= SHARE_RIGHT)]

    return respond
