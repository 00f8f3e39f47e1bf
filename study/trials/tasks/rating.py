"""Rating: a clip and its questionnaire, another, then questions that compare them (Wang IV.4).

Two orders of presentation, with people assigned evenly to both. Every question is a trial and a row
of the record; the first after a clip shows it.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from study.protocol.faults import Fault, given_methods, no_lengths, no_right_answers, table_at
from study.protocol.schema import ObserverTable, ProtocolFile, TomlTable
from study.trials.deck import Card, Deck, Supply
from study.trials.plan import Plan
from study.trials.prompt import Prompt, RatingScale
from study.trials.tasks.task import Held, Responder, Screens, Task
from study.trials.trial import ClipKey, Outcome

POINTS = ("1", "2", "3", "4", "5")
MIDDLE = 2  # of the ratings 0 to 4 that compare
COMPARED = "compared"


class RatingQuestion(TomlTable):
    """A question, and what stands at the ends of its five points."""

    name: Annotated[str, Field(min_length=1)]
    text: Annotated[str, Field(min_length=1)]
    low: str
    high: str


class RatingQuestions(TomlTable):
    """What is asked after each clip, and after both.

    Points that compare go from the clip shown first to the one shown second.
    """

    each: Annotated[tuple[RatingQuestion, ...], Field(min_length=1)]
    compared: tuple[RatingQuestion, ...] = ()


class Spread(TomlTable):
    """How ratings lie: their mean and SD before they are rounded to a point."""

    mean: float
    sd: Annotated[float, Field(ge=0)] = 1.0


class RatingObserver(ObserverTable):
    """Ratings 1 to 5 by question and method, comparing ones 0 (the method named first) to 4."""

    rate: dict[str, dict[str, Spread]] = Field(default_factory=dict)
    compare: dict[str, Spread] = Field(default_factory=dict)


class RatingFile(ProtocolFile):
    """A protocol of this task."""

    questions: RatingQuestions
    observer: RatingObserver | None = None


@dataclass(frozen=True)
class Rated:
    """A question about the clip in a position (1, 2), or about both (0).

    `shown` are the motion's two clips and `methods` what they are called, in the order shown.
    """

    motion: str
    methods: tuple[str, str]
    shown: tuple[ClipKey, ClipKey]
    position: int
    question: str
    shows: bool
    swapped: bool

    @property
    def method(self) -> str | None:
        """The method that the question is about; None where it compares."""
        return self.methods[self.position - 1] if self.position else None


def conditions(plan: Plan) -> dict[str, tuple[tuple[str, ClipKey], ...]]:
    """The two clips of each motion, by what they are called: a method, or a pair's condition."""
    file = plan.protocol.file
    found: dict[str, tuple[tuple[str, ClipKey], ...]] = {}
    for pair in file.stimuli.pairs(plan.rehearsal):
        if pair.condition is None:
            own = tuple((m, ClipKey(pair.name, method=m)) for m in file.methods)
        else:
            own = ((pair.condition, ClipKey(pair.name, method=file.methods[0])),)
        found[pair.group] = (*found.get(pair.group, ()), *own)
    return found


def start(plan: Plan) -> Supply:
    """The questions of each motion in turn, motions shuffled; a void trial is shown again at once.

    Clips lie in the order of the person's group.
    """
    questions = _file(plan).questions
    motions = list(conditions(plan))
    items = [
        (motions[n], position, question.name, first)
        for n in plan.generator(0).permutation(len(motions))
        for position, table in ((1, questions.each), (2, questions.each), (0, questions.compared))
        for first, question in zip([True] + [False] * len(table), table, strict=False)
    ]
    return Deck(tuple((Card(item),) for item in items))


def content(plan: Plan, card: Card, generator: np.random.Generator) -> Rated:
    """The question for a card."""
    motion, position, question, first = card.item
    assert isinstance(position, int)
    swapped = plan.group == 1
    (a, clip_a), (b, clip_b) = conditions(plan)[str(motion)]
    return Rated(
        motion=str(motion),
        methods=(b, a) if swapped else (a, b),
        shown=(clip_b, clip_a) if swapped else (clip_a, clip_b),
        position=position,
        question=str(question),
        shows=bool(first) and position > 0,
        swapped=swapped,
    )


def screens(trial: Rated) -> Screens:
    """The clip before its first question; nothing before the others."""
    return ((trial.shown[trial.position - 1],),) if trial.shows else ()


def clips(trial: Rated) -> tuple[ClipKey, ...]:
    """The clip that the question is about, or both, `clip_a` the one shown first."""
    return (trial.shown[trial.position - 1],) if trial.position else trial.shown


def ask(file: ProtocolFile, trial: Rated) -> Prompt:
    """The question's text and its five points."""
    assert isinstance(file, RatingFile)
    table = file.questions.each if trial.position else file.questions.compared
    asked = next(question for question in table if question.name == trial.question)
    scale = RatingScale(POINTS, asked.low, asked.high)
    return Prompt(asked.text, dict(zip(POINTS, POINTS, strict=True)), scale)


def correct(trial: Rated, response: str | None) -> bool | None:
    """A rating has no right answer."""
    return None


def row(trial: Rated, outcome: Outcome) -> dict[str, object]:
    """The task's own columns; comparing ratings go from 0, the method named first, to 4."""
    return {
        "motion": trial.motion,
        "order": "-".join(trial.methods),
        "position": trial.position or None,
        "method": trial.method,
        "question": trial.question,
        "rating": None if outcome.response is None else rating_of(trial, int(outcome.response)),
    }


def rating_of(trial: Rated, point: int) -> int:
    """The rating that a point (1 to 5) stands for."""
    if trial.position:
        return point
    toward_second = point - 1
    return 2 * MIDDLE - toward_second if trial.swapped else toward_second


def person(plan: Plan, truth: RatingObserver, generator: np.random.Generator) -> Responder:
    """A person whose ratings lie around the protocol's, all shifted by SD `spread`."""
    shift = truth.spread * generator.standard_normal()

    def respond(trial: Rated, draw: np.random.Generator) -> str:
        if trial.method is not None:
            own, add, least = truth.rate[trial.question][trial.method], shift, 1
        else:
            own, add, least = truth.compare[trial.question], 0.0, 0
        drawn = own.mean + add + own.sd * draw.standard_normal()
        rating = int(np.clip(np.floor(drawn + 0.5), least, least + 4))
        return str(next(n for n in range(1, 6) if rating_of(trial, n) == rating))

    return respond


def holds(file: ProtocolFile, truth: RatingObserver) -> Iterator[Held]:
    """The mean rating of each question, by method or comparing them."""
    asked = [(q, method, held) for q, rated in truth.rate.items() for method, held in rated.items()]
    for question, method, held in (*asked, *((q, "", held) for q, held in truth.compare.items())):

        def told(
            row: Mapping[str, Any], question: str = question, method: str = method
        ) -> float | None:
            about = row["method"] if isinstance(row["method"], str) else ""
            return float(row["rating"]) if (row["question"], about) == (question, method) else None

        yield Held(f"{question}{method and f', {method}'}", held.mean, told)


def faults(document: Mapping[str, Any]) -> Iterator[Fault]:
    """What is wrong with a protocol of this task beyond single keys."""
    trials = table_at(document, "trials")
    yield from no_right_answers(document)
    for key in ("practice", "repeats"):
        if trials.get(key):
            yield Fault(("trials", key), "a study of ratings has none; remove it")
    yield from no_lengths(document, "a study of ratings compares clips of two methods")
    yield from _two_clips(document)
    keys = table_at(document, "keys")
    for name in ("go_on", "quit"):
        if keys.get(name) in POINTS:
            yield Fault(("keys", name), f"expected a key beside {', '.join(POINTS)}, which rate")
    yield from _observed(document)


def _pairs(document: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    pairs = table_at(document, "stimuli").get("motions", ())
    return [p for p in pairs if isinstance(p, Mapping)] if isinstance(pairs, list) else []


def _called(document: Mapping[str, Any]) -> dict[str, list[str]]:
    """What the clips of each motion are called."""
    methods, found = given_methods(document), dict[str, list[str]]()
    for pair in _pairs(document):
        if pair.get("example"):
            continue
        own = [pair["condition"]] if pair.get("condition") else list(map(str, methods))
        found.setdefault(str(pair.get("of", pair.get("name"))), []).extend(map(str, own))
    return found


def _two_clips(document: Mapping[str, Any]) -> Iterator[Fault]:
    for motion, called in _called(document).items():
        if len(set(called)) != 2:
            message = (
                f"expected two clips of {motion} to be rated, two methods or two conditions, "
                f"found {', '.join(called) or 'none'}"
            )
            yield Fault(("stimuli", "motions"), message)


def _observed(document: Mapping[str, Any]) -> Iterator[Fault]:
    if not table_at(document, "observer"):
        return
    called = {name for names in _called(document).values() for name in names}
    for kind, path in (("each", "rate"), ("compared", "compare")):
        table = table_at(document, "questions").get(kind, ())
        asked = {str(q.get("name")) for q in table if isinstance(q, Mapping)}
        held = table_at(document, "observer", path)
        for name in sorted(asked - set(held)):
            yield Fault(("observer", path, name), "expected its mean and sd, found nothing; add it")
        for name in sorted(asked & set(held)):
            if kind == "each" and isinstance(held[name], Mapping) and set(held[name]) != called:
                message = f"expected a mean and sd for each of {sorted(called)}"
                yield Fault(("observer", path, name), message)


def _file(plan: Plan) -> RatingFile:
    file = plan.protocol.file
    assert isinstance(file, RatingFile)
    return file


TASK = Task(
    name="rating",
    layout="one-after-other",
    welcome=(
        "You will see two short animations, and answer some questions after each of them, "
        "and some about both at the end.\n\n"
        "Answer by the keys 1 to 5, or click on a point.\n\nPress {go_on} to begin."
    ),
    columns={
        "motion": "the motion shown",
        "order": "the two methods in the order shown",
        "position": "the place of the clip in that order (1 or 2); n/a for comparisons",
        "method": "the method of the clip; n/a for comparisons",
        "question": "the question asked",
        "rating": "1 to 5 from the low end; comparisons 0 (the method named first) to 4",
    },
    analysis="ratings",
    file=RatingFile,
    faults=faults,
    start=start,
    content=content,
    practice=None,  # it has examples instead
    catch=None,
    screens=screens,
    clips=clips,
    ask=ask,
    correct=correct,
    row=row,
    person=person,
    holds=holds,
    groups=lambda file: 2,
)
