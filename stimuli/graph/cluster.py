"""Building a graph on a Dask cluster: a clip's edges are one task, the collection is sent once."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from stimuli.errors import InputError, MachineError
from stimuli.graph.build import Branch, Mapped

PATIENCE = "5s"  # to find the scheduler


@contextmanager
def on_scheduler(address: str) -> Iterator[Mapped]:
    """A map over the workers of a Dask scheduler, for `build_graph`.

    InputError where Dask is not installed or nobody answers; MachineError where workers give out.
    """
    try:
        from distributed import Client
    except ImportError as error:
        raise InputError(
            "--scheduler: expected Dask's package distributed, found none.\n"
            "Install Segue with its extra `cluster`."
        ) from error
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise InputError(
            f"--scheduler {address}: expected a Dask scheduler, found none that answers.\n"
            "Start one with `dask scheduler`, workers with `dask worker`, and give its address."
        ) from error
    with client:
        if not client.scheduler_info(n_workers=-1)["workers"]:
            raise InputError(
                f"--scheduler {address}: expected workers, found none.\n"
                "Start them with `dask worker`."
            )

        def run(function: Callable[[Any, int], Branch], shared: Any, items: Sequence[int]) -> (
            Iterable[Branch]
        ):  # fmt: skip
            sent = client.scatter(shared, broadcast=True)
            tasks = [client.submit(function, sent, item, pure=False) for item in items]
            for task in tasks:
                try:
                    yield task.result()
                except InputError:
                    raise
                except Exception as error:
                    raise MachineError(
                        f"--scheduler {address}: a worker gave out: {error}.\n"
                        "See to its memory and to its versions of Segue and NumPy, and build again."
                    ) from error

        yield run
