"""A key that was pressed, and what a window needs of a keyboard."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol


class Press(NamedTuple):
    """A key, and the seconds from the flip since which keys count to when it went down."""

    name: str
    seconds: float


class Keyboard(Protocol):
    """What a window needs of a keyboard."""

    def listen(self) -> None:
        """From now on keys count; their times are from here."""

    def since(self) -> float:
        """Seconds since `listen`."""

    def pressed(self, names: Sequence[str], clear: bool = True) -> list[Press]:
        """Those of these keys pressed since `listen`, in order, held or already let go."""

    def measure(self) -> None:
        """Measure its clock again, between two blocks."""

    def timing(self) -> dict[str, object]:
        """Which keyboard it is and how exact its times are, for the record; times in ms."""

    def close(self) -> None:
        """Give it up."""
