"""Loops compiled by Numba, and whether they are worth loading.

Numba takes most of a second to load, once a process: as long as NumPy takes for a hundred short
clips. Whoever reads one clip is spared that; whoever reads many, or a long one, is
spared more. What comes out is the same, but for the last digits of sums.
"""

import sys
from collections.abc import Callable
from functools import cache
from typing import Any

ENOUGH = 4_000_000  # numbers worked on in a process, a hundred clips of ten seconds


def worth_loading(numbers: int) -> bool:
    """Whether a process that has so many more `numbers` to work on should load the loops."""
    done = _done_so_far()
    done[0] += numbers
    return done[0] > ENOUGH or "numba" in sys.modules


@cache
def _done_so_far() -> list[int]:
    return [0]


def compiled(**options: Any) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """`numba.njit` with `options`, compiled on the first call and kept on disk if that can be.

    Numba refuses to compile at all where neither the package's folder nor the user's home can be
    written.
    """
    import numba

    # sets of clips are built by forked processes
    numba.config.THREADING_LAYER = "forksafe"  # type: ignore[attr-defined]

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        try:
            return numba.njit(cache=True, error_model="numpy", **options)(function)
        except RuntimeError:  # nowhere to keep it
            return numba.njit(error_model="numpy", **options)(function)

    return decorate


def inlined(function: Callable[..., Any]) -> Callable[..., Any]:
    """A part of such a function, which a call of its own would slow down several times."""
    import numba

    return numba.njit(inline="always", error_model="numpy")(function)
