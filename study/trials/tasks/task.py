"""What a task is: a table of functions that the session and the record call."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from study.protocol.faults import Fault
from study.protocol.schema import ProtocolFile
from study.trials.deck import Card, Supply
from study.trials.plan import Plan
from study.trials.prompt import Prompt
from study.trials.trial import ClipKey, Outcome

Screens = tuple[tuple[ClipKey, ...], ...]
Responder = Callable[[Any, np.random.Generator], str]


class Held(NamedTuple):
    """A number of the table [observer], and what a row of a record tells of it (None: nothing)."""

    what: str
    truth: float
    told: Callable[[Mapping[str, Any]], float | None]


@dataclass(frozen=True)
class Task:
    """A task by its functions; `content` is the task's own frozen type.

    `file` is what a protocol of the task may say, `faults` finds what does not fit together in one.
    `start` gives the supply of main trials, `content` draws a trial for a card, `practice` and
    `catch` give cards outside the supply (None: the task has no such trials), `screens` says
    which clips are shown together and in what order (none: only the question is), `clips` which
    ones, two at most, the record names. `ask` is the question of a trial. `person` draws a
    simulated participant from the protocol's table [observer], and `holds` says what a study of
    such people should come to. `welcome` names the
    keys `{first}`, `{second}` and `{go_on}`, and the `{seconds}` to answer. `groups` is how many
    groups of people there are, who are given different orders. `analysis` names the part of the
    report that the answers go to. `settles` says exactly where each
    staircase settles on the protocol's observer, `ends` how often tracks of such people end at
    their first or last level (None: the task has no staircases).
    """

    name: str
    layout: str
    welcome: str
    columns: Mapping[str, str]
    analysis: str
    file: type[ProtocolFile]
    faults: Callable[[Mapping[str, Any]], Iterator[Fault]]
    start: Callable[[Plan], Supply]
    content: Callable[[Plan, Card, np.random.Generator], Any]
    practice: Callable[[Plan, np.random.Generator], Card] | None
    catch: Callable[[Plan, np.random.Generator], Card] | None
    screens: Callable[[Any], Screens]
    clips: Callable[[Any], tuple[ClipKey, ...]]
    ask: Callable[[ProtocolFile, Any], Prompt]
    correct: Callable[[Any, str | None], bool | None]
    row: Callable[[Any, Outcome], dict[str, object]]
    person: Callable[[Plan, Any, np.random.Generator], Responder]
    holds: Callable[[Any, Any], Iterator[Held]]
    answer_seconds: float | None = None
    settles: Callable[[Plan], list[dict[str, Any]]] | None = None
    ends: Callable[[Plan, np.random.Generator], list[dict[str, Any]]] | None = None
    groups: Callable[[ProtocolFile], int] = lambda file: 1


def alternatives(text: str, first: str, second: str) -> Callable[[ProtocolFile, Any], Prompt]:
    """The question of a choice between two, by the protocol's keys, in its words or in `text`."""

    def ask(file: ProtocolFile, trial: Any) -> Prompt:
        named = {"first": file.keys.first, "second": file.keys.second}
        said = file.instructions.question or text.format(**named)
        return Prompt(said, {file.keys.first: first, file.keys.second: second})

    return ask


def named_keys(file: ProtocolFile, task: Task) -> dict[str, Any]:
    """What a text may name: the keys, and the seconds to answer."""
    return {
        "first": file.keys.first,
        "second": file.keys.second,
        "go_on": file.keys.go_on.upper(),
        "seconds": file.presentation.answer_seconds or task.answer_seconds,
    }


def pages_of(file: ProtocolFile, task: Task) -> tuple[str, ...]:
    """The instructions that a session begins with: the protocol's, else the task's own."""
    welcome = file.instructions.welcome or task.welcome.format(**named_keys(file, task))
    return (welcome, *file.instructions.pages)
