"""What is asked after a trial: a text, the keys that answer it, and a scale where it has one."""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class RatingScale:
    """Points of a scale, as they are recorded, and what stands at its two ends."""

    points: tuple[str, ...]
    low: str
    high: str


@dataclass(frozen=True)
class Prompt:
    """A text, and the response that each key stands for; points of a scale can be clicked too."""

    text: str
    answers: Mapping[str, str]
    scale: RatingScale | None = None
