"""A protocol made concrete for one participant: motions with their lengths, and a seed."""

from dataclasses import dataclass, replace

import numpy as np

from stimuli.errors import InputError
from study.protocol.protocol import Protocol
from study.trials.trial import ClipKey


@dataclass(frozen=True)
class PlannedMotion:
    """A motion of the study; for lengths the reference k, and the differences of each side."""

    name: str
    category: str = ""
    reference: int | None = None
    shorter: tuple[int, ...] = ()
    longer: tuple[int, ...] = ()

    def sides(self) -> dict[str, tuple[int, ...]]:
        """The sides of k that hold levels, as ascending absolute differences."""
        return {
            side: levels
            for side, levels in (("shorter", self.shorter), ("longer", self.longer))
            if levels
        }


@dataclass(frozen=True, eq=False)
class Plan:
    """All that determines the trials of one session, given the answers."""

    protocol: Protocol
    motions: tuple[PlannedMotion, ...]
    seed: int
    rehearsal: bool = False
    group: int = 0  # of people, where a task gives groups different orders

    def generator(self, *key: int) -> np.random.Generator:
        """The generator for one purpose of this session, named by numbers."""
        return np.random.default_rng([self.seed, *key])


def make_plan(
    protocol: Protocol,
    references: dict[str, int],
    seed: int,
    rehearsal: bool = False,
    group: int = 0,
) -> Plan:
    """The plan of a session; `references` gives k of each motion where the task has lengths.

    A rehearsal takes the first motion only. Raises InputError when a length below one frame is
    asked for and the protocol does not drop such levels.
    """
    pairs = protocol.file.stimuli.pairs(rehearsal)
    motions = tuple(PlannedMotion(pair.name, pair.category) for pair in pairs)
    if protocol.file.stimuli.reference is not None:
        motions = tuple(_with_levels(protocol, m, references[m.name]) for m in motions)
    return Plan(protocol, motions, seed, rehearsal, group)


def _with_levels(protocol: Protocol, motion: PlannedMotion, k: int) -> PlannedMotion:
    stimuli = protocol.file.stimuli
    shorter = (*stimuli.shorter, *(k - length for length in stimuli.lengths if length < k))
    longer = (*stimuli.longer, *(length - k for length in stimuli.lengths if length > k))
    low = [d for d in shorter if k - d < 1]
    if low and not stimuli.drop_missing:
        raise InputError(
            f"{protocol.name}: motion {motion.name} has k = {k}, so differences {low} would need "
            "a blend below 1 frame; drop them, or set stimuli.drop_missing = true"
        )
    kept = tuple(sorted(d for d in shorter if k - d >= 1))
    return replace(motion, reference=k, shorter=kept, longer=tuple(sorted(longer)))


def examples_of(plan: Plan) -> list[tuple[str, ClipKey]]:
    """What is shown before the first trial: a text, then a clip by the study's first method."""
    file = plan.protocol.file
    if plan.rehearsal:
        return []
    method = file.methods[0] if file.methods else None
    k = file.stimuli.reference
    length = k if method is None and isinstance(k, int) else None
    return [
        (pair.example, ClipKey(pair.name, method=method, length=length))
        for pair in file.stimuli.motions
        if pair.example
    ]


def session_seed(seed: int, participant: int) -> int:
    """The seed of the n-th participant of a simulation, independent for each."""
    return int(np.random.SeedSequence([seed, participant]).generate_state(1, np.uint32)[0])
