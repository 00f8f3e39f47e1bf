"""Odd pair: two pairs of clips side by side; which pair holds two different ones (Wang VI.2)?"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field

from analysis.psychometric import location_for, proportion
from analysis.psychometric.functions import Array
from study.protocol.faults import Fault, given_lengths, given_methods, no_conditions, table_at
from study.protocol.schema import ObserverTable, Positive, ProtocolFile
from study.trials.chain import stationary
from study.trials.deck import Card, Supply, shuffled
from study.trials.ends import Observers, ends_of
from study.trials.plan import Plan
from study.trials.tasks.task import Held, Responder, Screens, Task, alternatives
from study.trials.tracks import StaircaseTable, Tracks, make_rule, start_tracks, track_faults
from study.trials.trial import ClipKey, Outcome

_GUESS = 0.5
SMALLEST_THRESHOLD = 0.5  # frames


class OddPairObserver(ObserverTable):
    """A psychometric function of the absolute difference for each side of the reference."""

    shorter: Annotated[float, Field(lt=0)] | None = None
    longer: Annotated[float, Field(gt=0)] | None = None
    at: Annotated[float, Field(gt=0.5, lt=1)] = 0.75
    function: str = "logistic"
    slope: Positive | None = None
    lapse: Annotated[float, Field(ge=0, lt=0.5)] = 0.0

    def sides(self) -> dict[str, float]:
        """The signed thresholds (frames) of the sides that have one."""
        both = {"shorter": self.shorter, "longer": self.longer}
        return {side: value for side, value in both.items() if value is not None}


class OddPairFile(ProtocolFile):
    """A protocol of this task: staircases, or without them the method of constant stimuli."""

    own_beside: ClassVar[int] = 2
    own_clips: ClassVar[int] = 4

    staircase: StaircaseTable | None = None
    observer: OddPairObserver | None = None


@dataclass(frozen=True)
class OddPair:
    """Reference (k, k) in one pair; in the other (k, k+d), with k+d left (1) or right (2)."""

    motion: str
    specification: str
    track: str
    reference_length: int
    length: int
    odd_pair: int
    odd_position: int

    @property
    def difference(self) -> int:
        """Signed frames by which the odd clip's blend differs from the reference."""
        return self.length - self.reference_length


def start(plan: Plan) -> Supply:
    """Staircases, or without them the method of constant stimuli."""
    table = _file(plan).staircase
    if table is not None:
        return start_tracks(plan, table)
    levels = [
        (motion.name, side, level)
        for motion in plan.motions
        for side, differences in motion.sides().items()
        for level in differences
    ]
    repeats = 1 if plan.rehearsal else plan.protocol.file.trials.repeats
    return shuffled([levels] * repeats, plan.generator(0))


def content(plan: Plan, card: Card, generator: np.random.Generator) -> OddPair:
    """The trial for a card; which pair is odd, and where in it, are drawn."""
    name, side, level = card.item
    assert isinstance(level, int)
    motion = next(m for m in plan.motions if m.name == name)
    assert motion.reference is not None
    odd_pair, odd_position = (int(v) for v in generator.integers(1, 3, size=2))
    return OddPair(
        motion=motion.name,
        specification=plan.protocol.file.stimuli.specification,
        track=str(side),
        reference_length=motion.reference,
        length=motion.reference + (level if side == "longer" else -level),
        odd_pair=odd_pair,
        odd_position=odd_position,
    )


def easiest(plan: Plan, generator: np.random.Generator) -> Card:
    """A card with the largest difference of a track drawn at random."""
    sides = [(m.name, side, levels[-1]) for m in plan.motions for side, levels in m.sides().items()]
    return Card(sides[int(generator.integers(len(sides)))])


def screens(trial: OddPair) -> Screens:
    """Pair 1, then pair 2, each (left, right)."""
    reference, odd = clips(trial)
    pair = (odd, reference) if trial.odd_position == 1 else (reference, odd)
    same = (reference, reference)
    return (pair, same) if trial.odd_pair == 1 else (same, pair)


def clips(trial: OddPair) -> tuple[ClipKey, ClipKey]:
    """`clip_a` is the reference, `clip_b` the one that differs."""
    return (
        ClipKey(trial.motion, length=trial.reference_length),
        ClipKey(trial.motion, length=trial.length),
    )


def correct(trial: OddPair, response: str | None) -> bool | None:
    """Whether the odd pair was found; None without an answer."""
    return None if response is None else response == str(trial.odd_pair)


def row(trial: OddPair, outcome: Outcome) -> dict[str, object]:
    """The task's own columns of the record."""
    right = correct(trial, outcome.response)
    return {
        "motion": trial.motion,
        "specification": trial.specification,
        "track": trial.track,
        "reference_length": trial.reference_length,
        "length": trial.length,
        "difference": trial.difference,
        "odd_pair": trial.odd_pair,
        "odd_position": trial.odd_position,
        "correct": None if right is None else int(right),
    }


def person(plan: Plan, truth: OddPairObserver, generator: np.random.Generator) -> Responder:
    """A person whose personal thresholds lie around the protocol's with SD `spread` (frames)."""
    assert truth.slope is not None
    slope, locations = truth.slope, {}
    for side, mean in (("shorter", truth.shorter), ("longer", truth.longer)):
        deviation = truth.spread * generator.standard_normal()
        if mean is not None:
            threshold = max(abs(mean) + deviation, SMALLEST_THRESHOLD)
            locations[side] = location_for(
                truth.function, threshold, truth.at, slope, _GUESS, truth.lapse
            )

    def respond(trial: OddPair, draw: np.random.Generator) -> str:
        level = abs(trial.difference)
        location = locations[trial.track]
        right = proportion(truth.function, level, location, slope, _GUESS, truth.lapse)
        found = draw.random() < float(right)
        return str(trial.odd_pair if found else 3 - trial.odd_pair)

    return respond


def holds(file: ProtocolFile, truth: OddPairObserver) -> Iterator[Held]:
    """The threshold of each side (signed frames), of which no row alone tells."""
    for side, threshold in truth.sides().items():
        yield Held(f"threshold {side}", threshold, lambda row: None)


def settles(plan: Plan) -> list[dict[str, Any]]:
    """Where each staircase settles on the protocol's observer, exactly, from its Markov chain.

    Rules without a finite chain, whose steps are parts of a level or follow a posterior, have the
    target of their formula, or none.
    """
    file = _file(plan)
    table, observer = file.staircase, file.observer
    if table is None or observer is None or observer.slope is None:
        return []
    found = []
    proportion_at = _right(observer)
    for motion in plan.motions:
        for side, levels in motion.sides().items():
            if side not in observer.sides():
                continue
            threshold = abs(observer.sides()[side])
            x = np.array(levels, float)
            row: dict[str, Any] = {"motion": motion.name, "side": side, "rule": table.rule,
                                   "levels": list(levels)}  # fmt: skip
            rule = make_rule(table)
            row["target"] = rule.target
            if rule.finite:
                settled = stationary(rule, x, proportion_at(threshold, x))
                mean = settled.mean_level
                row |= {
                    "mean_level": mean,
                    "target": float(proportion_at(threshold, np.array(mean))),
                    "overall_right": settled.overall_correct,
                }
            found.append(row)
    return found


def ends(plan: Plan, generator: np.random.Generator) -> list[dict[str, Any]]:
    """How often each track ends at its first or last level; once where motions have the same."""
    file, supply = _file(plan), start(plan)
    truth = file.observer
    if truth is None or truth.slope is None or not isinstance(supply, Tracks):
        return []
    told: dict[tuple[str, tuple[int, ...], int | None], list[str]] = {}
    for motion in plan.motions:
        for side, levels in motion.sides().items():
            room = motion.reference - 1 if motion.reference and side == "shorter" else None
            told.setdefault((side, levels, room), []).append(motion.name)
    return [
        ends_of(
            f"{', '.join(names)}/{side}",
            supply.tracks[names[0], side],
            Observers(abs(truth.sides()[side]), truth.spread, SMALLEST_THRESHOLD, _right(truth)),
            room,
            generator,
        )
        for (side, _, room), names in told.items()
        if side in truth.sides()
    ]


def _right(truth: OddPairObserver) -> Callable[[float, Array], Array]:
    """The proportion right at levels of somebody with a threshold."""
    assert truth.slope is not None
    curve = (truth.slope, _GUESS, truth.lapse)

    def right(threshold: float, levels: Array) -> Array:
        location = location_for(truth.function, threshold, truth.at, *curve)
        return proportion(truth.function, levels, location, *curve)

    return right


def faults(document: Mapping[str, Any]) -> Iterator[Fault]:
    """What is wrong with an odd-pair protocol beyond single keys."""
    yield from no_conditions(document)
    stimuli = table_at(document, "stimuli")
    if stimuli.get("reference") is None:
        yield Fault(("stimuli", "reference"), "expected the length k (frames or 'geodesic')")
    if not given_lengths(document):
        yield Fault(("stimuli", "lengths"), "expected lengths, or differences shorter and longer")
    if given_methods(document):
        yield Fault(("methods",), "an odd-pair study compares lengths; remove its methods")
    yield from track_faults(document)
    observer = table_at(document, "observer")
    if not observer:
        return
    if "slope" not in observer:
        yield Fault(("observer", "slope"), "expected this key, found nothing; add it")
    if stimuli.get("lengths") or (stimuli.get("shorter") and stimuli.get("longer")):
        for key in ("shorter", "longer"):
            if key not in observer:
                yield Fault(("observer", key), "expected the signed threshold in frames; add it")


def _file(plan: Plan) -> OddPairFile:
    file = plan.protocol.file
    assert isinstance(file, OddPairFile)
    return file


_QUESTION = (
    "Which pair held two different motions?\n\n{first}   the first pair\n{second}   the second pair"
)

TASK = Task(
    name="odd-pair",
    layout="side-by-side",
    welcome=(
        "You will see two pairs of short animations, one pair after the other.\n"
        "In one pair the two animations are the same, in the other they differ.\n\n"
        "Which pair held two different ones? "
        "Press {first} for the first pair, {second} for the second.\n"
        "If you are not sure, guess.\n\nPress {go_on} to begin."
    ),
    columns={
        "motion": "the transition shown",
        "specification": "how the transition is specified (start-end or center-aligned)",
        "track": "the side of the reference length: shorter or longer",
        "reference_length": "blend length of the reference, frames",
        "length": "blend length of the clip that differs, frames",
        "difference": "length minus reference_length, signed frames",
        "odd_pair": "the pair that holds two different clips (1 or 2)",
        "odd_position": "where in that pair the different clip lies (1 left, 2 right)",
        "correct": "1 when response equals odd_pair, else 0",
    },
    analysis="thresholds",
    file=OddPairFile,
    faults=faults,
    start=start,
    content=content,
    practice=easiest,
    catch=easiest,
    screens=screens,
    clips=clips,
    ask=alternatives(_QUESTION, "1", "2"),
    correct=correct,
    row=row,
    person=person,
    holds=holds,
    settles=settles,
    ends=ends,
)
