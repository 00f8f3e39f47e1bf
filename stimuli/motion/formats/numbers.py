"""Long runs of decimal numbers in the bytes of a file, and what is told of a word that is none.

Comments are met only where a scan stops, and are blanked then, letter by letter, so that what comes
after them keeps its place.
"""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from stimuli.motion.formats.scan import scan
from stimuli.motion.formats.scan_state import (
    BEGINS,
    ENDED,
    NO_NUMBER,
    PLACE,
    UNCERTAIN,
    WORDS,
    State,
    new_state,
)
from stimuli.motion.formats.source import fault, line_of, shown
from stimuli.motion.formats.words import (
    IN_BOUNDS,
    decimal,
    is_decimal,
)
from stimuli.motion.quaternions import Array

_TODO = "The file is damaged; export it again."
_WORD = re.compile(rb"\S+")
_COMMENT = re.compile(rb"(?<!\S)(?:#|//)[^\r\n]*")  # a word of its own, unlike that in -1.#IND


def parse_numbers(path: Path, data: bytes, start: int = 0) -> Array:
    """All numbers of a text from `start` on; InputError with line and word where one is none."""
    most = (len(data) - start) // 2 + 1
    blocks = list(number_blocks(path, data, new_state(start), most, 1, comments=False))
    return blocks[0] if blocks else np.empty(0)


def number_blocks(
    path: Path, data: bytes, state: State, size: int, usual: int, comments: bool = True
) -> Iterator[Array]:
    """The numbers from the state's place on, `size` at a time, the last block with what is left.

    `usual` is how many words a line should have; the state counts lines that have not.
    `comments` tells whether there may be some.
    """
    codes = np.frombuffer(data, dtype=np.uint8)
    blanked, filled, values = not comments, 0, np.empty(size)
    while True:
        why, count = scan(codes, state, values[filled:], usual)
        filled += count
        if why == UNCERTAIN:
            match = _WORD.match(data, int(state[PLACE]))
            number = decimal(match[0].decode("ascii")) if match else None
            if match is None or number is None:
                raise _culprit(path, data, int(state[PLACE]))
            values[filled] = number
            filled += 1
            if state[WORDS] == 0:
                state[BEGINS] = state[PLACE]
            state[PLACE], state[WORDS] = match.end(), state[WORDS] + 1
        elif why == NO_NUMBER:
            if blanked:
                raise _culprit(path, data, int(state[PLACE]))
            blanked = True
            rest = _COMMENT.sub(lambda found: b" " * len(found[0]), data[state[PLACE] :])
            data = data[: state[PLACE]] + rest
            codes = np.frombuffer(data, dtype=np.uint8)
        elif why == ENDED:
            if filled:
                yield values[:filled]
            return
        if filled == size:
            yield values
            filled, values = 0, np.empty(size)


def _culprit(path: Path, data: bytes, place: int) -> Exception:
    """The fault of the word at a place, which is no usable number."""
    match = _WORD.match(data, place)
    word = match[0].decode("utf-8", "replace") if match else ""
    wanted = f"a number {IN_BOUNDS}" if is_decimal(word) and decimal(word) is None else "a number"
    return fault(path, wanted, shown(word), _TODO, line_of(data, place))
