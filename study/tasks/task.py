"""What a task is: a table of functions that the session and the record call."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from study.deck import Card, Source
from study.plan import Plan
from study.trial import ClipKey, Outcome

Screens = tuple[tuple[ClipKey, ...], ...]


@dataclass(frozen=True)
class Task:
    """A task by its functions; `content` is the task's own frozen type.

    `start` gives the source of main trials, `content` draws a trial for a card, `practice` and
    `catch` give cards outside the source (None: the task has no such trials), `screens` says
    which clips are shown together and in what order, `clips` which two the record names. `question`
    and `welcome` name the keys `{first}`, `{second}` and `{go_on}`, and the `{seconds}` to answer.
    """

    name: str
    responses: tuple[str, str]
    layout: str
    question: str
    welcome: str
    columns: Mapping[str, str]
    start: Callable[[Plan], Source]
    content: Callable[[Plan, Card, np.random.Generator], Any]
    practice: Callable[[Plan, np.random.Generator], Card]
    catch: Callable[[Plan, np.random.Generator], Card] | None
    screens: Callable[[Any], Screens]
    clips: Callable[[Any], tuple[ClipKey, ClipKey]]
    correct: Callable[[Any, str | None], bool | None]
    row: Callable[[Any, Outcome], dict[str, object]]
    answer_seconds: float | None = None
