"""Loops compiled by numba, kept on disk between runs where this user has a place for that."""

from collections.abc import Callable
from typing import Any


def compiled(**options: Any) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """`numba.njit` with `options`, compiled on the first call and cached on disk if that can be.

    Numba refuses to compile at all where neither the package's folder nor the user's home can be
    written.
    """
    import numba

    # sets of clips are built by forked processes
    numba.config.THREADING_LAYER = "forksafe"  # type: ignore[attr-defined]

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        try:
            return numba.njit(cache=True, **options)(function)
        except RuntimeError:
            return numba.njit(**options)(function)

    return decorate
