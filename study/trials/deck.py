"""Where main trials come from: the card that a supply gives, and a shuffled deck of them.

A supply is a frozen value with three methods: `draw` gives the next card, `answered` and
`void` give the supply after that card was answered, or was shown too badly to count.
`study.trials.tracks` has the other, interleaved staircases.
"""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np


class Card(NamedTuple):
    """What a trial asks; for a repetition the first trial's number and how often it came back."""

    item: tuple[Hashable, ...]
    repeat_of: int | None = None
    times: int = 0


class Supply(Protocol):
    """A supply of main trials that is a pure function of its past."""

    def draw(self, generator: np.random.Generator) -> Card | None:
        """The next card, or None when the study has all its trials."""

    def answered(self, card: Card, correct: bool | None) -> "Supply":
        """The supply after an answer that counts."""

    def void(self, card: Card, number: int) -> "Supply":
        """The supply after trial `number` showed the card too badly to count."""


@dataclass(frozen=True)
class Deck:
    """Blocks of cards still to show; the first card of the first block is next."""

    blocks: tuple[tuple[Card, ...], ...]

    def draw(self, generator: np.random.Generator) -> Card | None:
        """The top card; the order was drawn when the deck was shuffled."""
        return self.blocks[0][0] if self.blocks else None

    def answered(self, card: Card, correct: bool | None) -> "Deck":
        """The deck without its top card."""
        block, *rest = self.blocks
        return Deck((block[1:], *rest) if len(block) > 1 else tuple(rest))

    def void(self, card: Card, number: int) -> "Deck":
        """The deck with its top card at the end of its block."""
        block, *rest = self.blocks
        again = Card(card.item, card.repeat_of or number, card.times + 1)
        return Deck(((*block[1:], again), *rest))


def shuffled(
    blocks: Sequence[Sequence[tuple[Hashable, ...]]], generator: np.random.Generator
) -> Deck:
    """A deck whose blocks keep their order and whose cards are shuffled within each."""
    return Deck(
        tuple(
            tuple(Card(block[n]) for n in generator.permutation(len(block)))
            for block in blocks
            if len(block)
        )
    )
