"""Whether the compiled loops are worth loading.

Numba takes most of a second to load, once a process: as long as plain Python takes for dozens of
short clips. Whoever reads one clip is spared that; whoever reads many, or a long one, is spared
more. What is read is the same.
"""

import sys
from functools import cache

ENOUGH = 1_000_000  # bytes read in a process


def worth_loading(size: int) -> bool:
    """Whether a process that has another `size` bytes to read should load them, if it has not."""
    read = _read_so_far()
    read[0] += size
    return read[0] > ENOUGH or "numba" in sys.modules


@cache
def _read_so_far() -> list[int]:
    return [0]
