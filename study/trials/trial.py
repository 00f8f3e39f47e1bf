"""The words that tasks, sessions and records share: clips by name, trials, what came of them."""

from dataclasses import dataclass
from typing import Any, NamedTuple


class ClipKey(NamedTuple):
    """A clip of a stimulus set: a motion, joined by a method or with a length in frames."""

    motion: str
    method: str | None = None
    length: int | None = None

    @property
    def called(self) -> str:
        """The clip in words, where no set names it."""
        return f"{self.motion}/{self.method or self.length}"


@dataclass(frozen=True)
class Trial:
    """One trial to show: its number in the session (from 1), its phase, its task's content."""

    number: int
    phase: str
    content: Any
    repeat_of: int | None = None


@dataclass(frozen=True)
class Outcome:
    """What came of a trial: the response (None: no answer), seconds, and how it was shown.

    `late_frames` is None where frames were left out on purpose.
    """

    response: str | None
    response_time: float | None
    onset: float
    late_frames: int | None = 0
    void: bool = False
    replays: int = 0
