"""What a task is: a table of functions that the session and the record call."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from study.protocol.faults import Fault
from study.protocol.schema import ProtocolFile
from study.trials.deck import Card, Supply
from study.trials.plan import Plan
from study.trials.trial import ClipKey, Outcome

Screens = tuple[tuple[ClipKey, ...], ...]
Responder = Callable[[Any, np.random.Generator], str]


@dataclass(frozen=True)
class Task:
    """A task by its functions; `content` is the task's own frozen type.

    `file` is what a protocol of the task may say, `faults` finds what does not fit together in one.
    `start` gives the supply of main trials, `content` draws a trial for a card, `practice` and
    `catch` give cards outside the supply (None: the task has no such trials), `screens` says
    which clips are shown together and in what order, `clips` which two the record names. `person`
    draws a simulated participant from the protocol's table [observer]. `question` and `welcome`
    name the keys `{first}`, `{second}` and `{go_on}`, and the `{seconds}` to answer. `analysis`
    names the part of the report that the answers go to. `settles` says exactly where each
    staircase settles on the protocol's observer (None: the task has no staircases).
    """

    name: str
    responses: tuple[str, str]
    layout: str
    question: str
    welcome: str
    columns: Mapping[str, str]
    analysis: str
    file: type[ProtocolFile]
    faults: Callable[[Mapping[str, Any]], Iterator[Fault]]
    start: Callable[[Plan], Supply]
    content: Callable[[Plan, Card, np.random.Generator], Any]
    practice: Callable[[Plan, np.random.Generator], Card]
    catch: Callable[[Plan, np.random.Generator], Card] | None
    screens: Callable[[Any], Screens]
    clips: Callable[[Any], tuple[ClipKey, ClipKey]]
    correct: Callable[[Any, str | None], bool | None]
    row: Callable[[Any, Outcome], dict[str, object]]
    person: Callable[[Plan, Any, np.random.Generator], Responder]
    answer_seconds: float | None = None
    settles: Callable[[Plan], list[dict[str, Any]]] | None = None
