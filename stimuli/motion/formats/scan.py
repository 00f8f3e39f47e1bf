"""The numbers of a text in one pass over its bytes, each correctly rounded.

A number of at most 2⁵³ and a power of ten up to 22 are one exact operation apart (Clinger 1990).
Any other of a moderate size is scaled in twice the precision of a double; the few whose rounding is
not certain even then are left to Python.
"""

from fractions import Fraction
from functools import cache

import numpy as np
import numpy.typing as npt

from stimuli.motion.quaternions import Array

Codes = npt.NDArray[np.uint8]
State = npt.NDArray[np.int64]

# A scan's state: the byte at which it goes on; words in its line so far, and where that begins;
# lines with words; how many have another number of words than usual; the first of these: where it
# begins, which it is of the lines with words, and its words.
PLACE, WORDS, BEGINS, LINES, ODD_LINES, ODD_BEGINS, ODD_LINE, ODD_WORDS = range(8)
FULL, ENDED, NO_NUMBER, UNCERTAIN = range(4)  # why a scan comes back
POWERS = 60  # of ten, either way, by which a number is scaled without Python


def new_state(start: int) -> State:
    """The state of a scan that begins at a byte."""
    state = np.zeros(8, dtype=np.int64)
    state[[PLACE, BEGINS]] = start
    return state


def scan(codes: Codes, state: State, values: Array, usual: int) -> tuple[int, int]:
    """Fills `values` with the next numbers of a text; why it stopped, and how many there are.

    `usual` is how many words a line should have. At a word that is no number below 1e9 (NO_NUMBER),
    or one that Python must read (UNCERTAIN), the state's PLACE is where the word begins.
    """
    from stimuli.motion.formats.scan_loop import fill

    why, count = fill(codes, state, values, usual, *_powers())
    return int(why), int(count)


@cache
def _powers() -> tuple[Array, Array]:
    """10^k for k from −POWERS to POWERS, each as the sum of two doubles."""
    powers = [Fraction(10) ** k for k in range(-POWERS, POWERS + 1)]
    high = [float(power) for power in powers]
    low = [float(power - Fraction(near)) for power, near in zip(powers, high, strict=True)]
    return np.array(high), np.array(low)
