"""A function mapped over jobs on all cores, or in this process where that cannot be."""

import os
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any, TypeVar

from stimuli.errors import InputWarning

_Job = TypeVar("_Job")
_Found = TypeVar("_Found")


def mapped(
    function: Callable[[_Job], _Found], jobs: Sequence[_Job], workers: int | None, most: int
) -> Iterator[_Found]:
    """What `function` makes of each job, in order, in at most `most` processes.

    `workers` limits them too (default: all cores). The function and the jobs are pickled.
    """
    count = min(workers or os.cpu_count() or 1, most, len(jobs))
    pool = _pool(count) if count > 1 else None
    if pool is None:
        yield from map(function, jobs)
        return
    with pool:
        yield from pool.map(function, jobs)


def _pool(count: int) -> Any:
    """Processes, or None where the system gives this user no semaphores to share."""
    try:
        return ProcessPoolExecutor(count, mp_context=get_context("spawn"))
    except (OSError, ImportError) as error:
        warnings.warn(
            f"working on one core alone: processes cannot share semaphores here ({error}); "
            "let this user write to /dev/shm",
            InputWarning,
            stacklevel=3,
        )
        return None
