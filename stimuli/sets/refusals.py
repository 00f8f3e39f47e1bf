"""All that a set's input is refused for, told together: a protocol is mended once."""

from collections.abc import Callable, Iterable, Sequence
from typing import TypeVar

from stimuli.errors import InputError

_Made = TypeVar("_Made")


class RefusedError(InputError):
    """One or more faults of input; several are told in a line each."""

    def __init__(self, faults: Sequence[str]) -> None:
        self.faults = tuple(dict.fromkeys(faults))
        lines = [" ".join(fault.splitlines()) for fault in self.faults]
        super().__init__("\n".join(lines if len(lines) > 1 else self.faults))


def together(works: Iterable[Callable[[], _Made]], where: str = "") -> list[_Made]:
    """What each work returns; RefusedError of every InputError that any of them raises.

    `where` is said before each fault.
    """
    made: list[_Made] = []
    faults: list[str] = []
    for work in works:
        try:
            made.append(work())
        except RefusedError as error:
            faults += error.faults
        except InputError as error:
            faults.append(str(error))
    if faults:
        raise RefusedError([f"{where}{fault}" for fault in faults])
    return made
