"""Odd pair: two pairs of clips side by side; which pair holds two different ones (Wang VI.2)?"""

from dataclasses import dataclass

import numpy as np

from study.deck import Card, Source, shuffled
from study.plan import Plan
from study.tasks.task import Screens, Task
from study.tracks import start_tracks
from study.trial import ClipKey, Outcome


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


def start(plan: Plan) -> Source:
    """Staircases, or without them the method of constant stimuli."""
    table = plan.protocol.file.staircase
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


TASK = Task(
    name="odd-pair",
    responses=("1", "2"),
    layout="side-by-side",
    question=(
        "Which pair held two different motions?\n\n"
        "{first}   the first pair        {second}   the second pair"
    ),
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
    start=start,
    content=content,
    practice=easiest,
    catch=easiest,
    screens=screens,
    clips=clips,
    correct=correct,
    row=row,
)
