"""The numbers of a text in one pass over its bytes, each correctly rounded.

A number of at most 2⁵³ and a power of ten up to 22 are one exact operation apart (Clinger 1990).
Any other of a moderate size is scaled in twice the precision of a double; the few whose rounding is
not certain even then are left to Python.
"""

from fractions import Fraction
from functools import cache

import numpy as np

from stimuli.motion.formats.scan_state import POWERS, Codes, State
from stimuli.motion.quaternions import Array


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
