"""Interleaved staircases: one track for each motion and side, the next drawn by the seed."""

import inspect
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from study.protocol.faults import Fault, one_of, table_at
from study.protocol.schema import Count, Positive, TomlTable
from study.trials.deck import Card
from study.trials.plan import Plan
from study.trials.rules import RULES
from study.trials.staircase import MOST_TRIALS, Rule, Stop, Track, answer, start_track

Key = tuple[str, str]


class StopTable(TomlTable):
    """When a track ends: all named counts, combined by any or all; after `most` trials anyway."""

    visits: Count | None = None
    reversals: Count | None = None
    trials: Count | None = None
    combine: Literal["any", "all"] = "any"
    most: Count = MOST_TRIALS


class StaircaseTable(TomlTable):
    """The rule of every track, with its own numbers, and when a track ends.

    A track begins at the level nearest `start` (frames of difference), else at its largest.
    """

    rule: str
    start: Count | None = None
    n_down: Count | None = None
    n_up: Count | None = None
    down: Positive | None = None
    up: Positive | None = None
    lapse: Annotated[float, Field(ge=0, lt=0.5)] | None = None
    stop: StopTable


RULE_NUMBERS = ("n_down", "n_up", "down", "up", "lapse")  # which of them a rule takes is its own


@dataclass(frozen=True)
class Tracks:
    """A supply of trials (see `study.trials.deck`): tracks by (motion, side), void trials of each.

    `again` holds for a track the number of the trial to be asked again and how often it was.
    """

    tracks: Mapping[Key, Track]
    again: Mapping[Key, tuple[int, int]] = field(default_factory=dict)

    def draw(self, generator: np.random.Generator) -> Card | None:
        """The next (motion, side, difference), evenly from the unfinished tracks."""
        unfinished = [key for key, track in self.tracks.items() if track.stopped_by is None]
        if not unfinished:
            return None
        key = unfinished[int(generator.integers(len(unfinished)))]
        repeat_of, times = self.again.get(key, (None, 0))
        return Card((*key, self.tracks[key].level), repeat_of, times)

    def answered(self, card: Card, correct: bool | None) -> "Tracks":
        """The card's track moves on."""
        key = _key(card)
        again = {other: value for other, value in self.again.items() if other != key}
        return Tracks({**self.tracks, key: answer(self.tracks[key], bool(correct))}, again)

    def void(self, card: Card, number: int) -> "Tracks":
        """The track's next trial is at the unchanged level."""
        again = (card.repeat_of or number, card.times + 1)
        return replace(self, again={**self.again, _key(card): again})


def _key(card: Card) -> Key:
    motion, side, _ = card.item
    return str(motion), str(side)


def start_tracks(plan: Plan, table: StaircaseTable) -> Tracks:
    """All tracks of a plan at their largest differences."""
    rule, stop = make_rule(table), make_stop(table)
    if plan.rehearsal:
        stop = Stop((("trials", plan.protocol.file.rehearsal.trials),))
    return Tracks(
        {
            (motion.name, side): start_track(
                f"{motion.name}/{side}", levels, rule, stop, table.start
            )
            for motion in plan.motions
            for side, levels in motion.sides().items()
        }
    )


def make_rule(table: StaircaseTable) -> Rule:
    """The rule that a protocol names, with the numbers that it gives."""
    numbers = table.model_dump(include=set(RULE_NUMBERS), exclude_none=True)
    return RULES[table.rule](**numbers)


def make_stop(table: StaircaseTable) -> Stop:
    """The stopping rule that a protocol states."""
    counts = table.stop.model_dump(include={"visits", "reversals", "trials"}, exclude_none=True)
    return Stop(tuple(counts.items()), all if table.stop.combine == "all" else any, table.stop.most)


def track_faults(document: Mapping[str, Any]) -> Iterator[Fault]:
    """What is wrong with a protocol's staircase: its rule, the rule's numbers, when it stops."""
    table = table_at(document, "staircase")
    rule = table.get("rule")
    if rule is None:
        return
    if rule not in RULES:
        yield Fault(("staircase", "rule"), one_of(rule, tuple(RULES)))
    else:
        takes = inspect.signature(RULES[rule]).parameters
        for key in table:
            if key in RULE_NUMBERS and key not in takes:
                yield Fault(("staircase", key), f"the rule {rule} takes no {key}; remove it")
    stop = table_at(document, "staircase", "stop")
    if "stop" in table and not set(stop) & {"visits", "reversals", "trials"}:
        yield Fault(("staircase", "stop"), "expected visits, reversals or trials, found none")
