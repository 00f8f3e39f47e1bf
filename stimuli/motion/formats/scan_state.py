"""What a scan of numbers knows of where it is, shared by the scan and its compiled loop."""

import numpy as np
import numpy.typing as npt

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
