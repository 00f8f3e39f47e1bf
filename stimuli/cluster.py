"""A Dask cluster that somebody started: `distributed` does the work, this is how it is asked.

The workers' environment has Segue installed; they need none of this machine's files, since what a
job needs travels with it, and what comes of it travels back.
"""

import asyncio
import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from queue import Empty, Queue
from typing import Any

from stimuli.errors import InputError, MachineError

PATIENCE = 5.0  # seconds for a scheduler to answer, and between looks at whether workers are left
_LOSSES = 3  # of what all jobs share, before the cluster is given up
DEAD = "the work that came back is kept.\nSee to the cluster, and run it again"


class Cluster:
    """A scheduler's client: jobs go to its workers, results come back as they are done."""

    def __init__(self, client: Any, address: str) -> None:
        self._client, self._address = client, address

    def spread(
        self, function: Callable[..., Any], jobs: Sequence[Any], shared: Any = None
    ) -> Iterator[tuple[int, Any]]:
        """(place of the job, what `function` made of it), as jobs are done.

        What is `shared` is sent to every worker once, and given after the job. A job whose worker
        dies is done by another, what was shared being sent anew where it died with its holders;
        MachineError where that does not help.
        """
        held = self._held(shared)
        ended: Queue[tuple[int, Any]] = Queue()
        asked: dict[int, tuple[Any, Any]] = {}  # of each job its future, and what it was given

        def ask(place: int) -> None:
            more = () if shared is None else (held,)
            future = self._client.submit(function, jobs[place], *more, pure=False, priority=-place)
            asked[place] = (future, held)
            future.add_done_callback(lambda future: ended.put((place, future)))

        for place in range(len(jobs)):
            ask(place)
        losses = 0
        while asked:
            place, future = self._next(ended)
            _, given = asked.pop(place)  # so that the cluster forgets it
            if future.cancelled() and losses < _LOSSES and self._workers():
                # what was shared is gone with the workers that had it: sent anew, asked again
                if given is held:
                    held, losses = self._held(shared), losses + 1
                ask(place)
                continue
            yield place, self._found(future)

    def everywhere(self, function: Callable[[], object]) -> None:
        """Call a function once in every worker that is there; one may be gone by then."""
        with suppress(OSError):  # of a worker that the scheduler has not missed yet
            self._client.run(function, on_error="ignore")

    def _held(self, shared: Any) -> Any:
        if shared is None:
            return None
        return self._client.scatter([shared], broadcast=True, hash=False)[0]

    def _next(self, ended: "Queue[tuple[int, Any]]") -> tuple[int, Any]:
        """The next job that has ended; MachineError when nobody is left to end one."""
        while True:
            try:
                return ended.get(timeout=PATIENCE)
            except Empty:
                if not self._workers():
                    raise MachineError(
                        f"{self._address}: expected workers that work, found none left; {DEAD}"
                    ) from None

    def _workers(self) -> int:
        try:
            return len(self._client.scheduler_info(n_workers=-1)["workers"])
        except Exception:  # a lost connection has many faces
            return 0

    def _found(self, future: Any) -> Any:
        from distributed import CancelledError
        from distributed.scheduler import KilledWorker

        try:
            return future.result()
        except KilledWorker as error:
            raise MachineError(
                f"{self._address}: expected a worker that lives through its work, found several "
                f"dead of one job, as when memory runs out; {DEAD}"
            ) from error
        except CancelledError as error:
            raise MachineError(
                f"{self._address}: expected the cluster to the end, found the connection lost; "
                f"{DEAD}"
            ) from error
        except ModuleNotFoundError as error:
            raise InputError(
                f"{self._address}: expected Segue where the workers run, found no module "
                f"{error.name}.\nInstall there what is installed here."
            ) from error


@contextmanager
def cluster(address: str) -> Iterator[Cluster]:
    """The cluster of the Dask scheduler at an address, such as tcp://10.0.0.1:8786.

    InputError where nobody answers, or a scheduler without workers.
    """
    try:
        import distributed
    except ImportError as error:
        raise InputError(
            "--scheduler: expected Dask's distributed, found it is not installed.\n"
            "Install it with `pip install 'segue[cluster]'`, or leave the option out."
        ) from error
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what matters is said here
    workers = _answering(address)
    if not workers:
        raise InputError(
            f"--scheduler {address}: expected a Dask scheduler with workers, found one without.\n"
            f"Start some: `dask worker {address} --nworkers auto --nthreads 1`."
        )
    with distributed.Client(address, timeout=PATIENCE, set_as_default=False) as client:
        yield Cluster(client, address)


def _answering(address: str) -> int:
    """How many workers a scheduler has; InputError where none answers as one."""
    from distributed.core import rpc

    async def asked() -> int:
        async with rpc(address, timeout=PATIENCE) as scheduler:
            told = await scheduler.identity(n_workers=-1)
        return len(told["workers"])

    try:
        return asyncio.run(asyncio.wait_for(asked(), PATIENCE))
    except Exception as error:  # whatever else answers there answers in a way of its own
        why = "nobody who answers" if isinstance(error, OSError | TimeoutError) else str(error)
        raise InputError(
            f"--scheduler {address}: expected a Dask scheduler, found {why}.\n"
            "Start one with `dask scheduler`, or leave the option out: all cores here then work."
        ) from error
