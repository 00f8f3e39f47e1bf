"""A function mapped over jobs on all cores, on a cluster, or in this process where that must be."""

import os
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any, TypeVar

from stimuli.cluster import cluster
from stimuli.errors import InputWarning

_Job = TypeVar("_Job")
_Found = TypeVar("_Found")


def mapped(
    function: Callable[[_Job], _Found],
    jobs: Sequence[_Job],
    workers: int | None,
    most: int,
    scheduler: str | None = None,
) -> Iterator[_Found]:
    """What `function` makes of each job, in order, in at most `most` processes.

    `workers` limits them too (default: all cores); a Dask `scheduler`'s address gives the jobs to
    its cluster instead. The function and the jobs are pickled.
    """
    if scheduler is not None:
        yield from _on_cluster(function, jobs, scheduler)
        return
    count = min(workers or os.cpu_count() or 1, most, len(jobs))
    pool = _pool(count) if count > 1 else None
    if pool is None:
        yield from map(function, jobs)
        return
    with pool:
        yield from pool.map(function, jobs)


def _on_cluster(
    function: Callable[[_Job], _Found], jobs: Sequence[_Job], scheduler: str
) -> Iterator[_Found]:
    """The results in order, whichever is done first."""
    done: dict[int, _Found] = {}
    told = 0
    with cluster(scheduler) as workers:
        for place, found in workers.spread(function, jobs):
            done[place] = found
            while told in done:
                yield done.pop(told)
                told += 1


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
