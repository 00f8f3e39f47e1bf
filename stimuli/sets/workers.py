"""Who draws: processes here, one a core with one OpenGL context each, or a cluster.

A process is spawned, not forked, and talks over a pipe: when the one that started it dies, the
pipe closes and it ends. It holds one group's scenery and one frame at a time, however long a set.
"""

import multiprocessing
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any

from stimuli.cluster import cluster
from stimuli.errors import InputError, MachineError
from stimuli.sets.drawing import ENVIRONMENT, Drawing, draw_on_cluster, stop_drawing
from stimuli.sets.frames import DrawJob, DrawnFrame, Scenery
from stimuli.sets.naming import RECIPE

AT_ONCE = 16  # frames a message


@dataclass(frozen=True)
class Crew:
    """How many processes here (None: all cores), or the address of a Dask scheduler; the device."""

    workers: int | None = None
    scheduler: str | None = None
    device: str = "auto"


Taken = Callable[[Sequence[DrawnFrame], str], None]  # frames, and the driver that drew them


def draw_all(
    jobs: Sequence[DrawJob], sceneries: Mapping[str, Scenery], codec: str, crew: Crew, taken: Taken
) -> None:
    """Draw jobs, in any order; `taken` is called for some frames at a time.

    MachineError or RuntimeError when a worker fails or dies.
    """
    if crew.scheduler is not None:
        _on_cluster(jobs, sceneries, codec, crew, taken)
        return
    count = min(crew.workers or os.cpu_count() or 1, len(jobs))
    with _started(count, codec, crew.device) as team:
        waiting = list(reversed(jobs))
        held: dict[Connection, str] = {}

        def next_job(pipe: Connection) -> int:
            if not waiting:
                return 0
            job = waiting.pop()
            with _living():
                if held.get(pipe) != job.scenery:
                    held[pipe] = job.scenery
                    pipe.send(sceneries[job.scenery])
                pipe.send(job)
            return 1

        busy = sum(next_job(pipe) for pipe in team)
        while busy:
            ready = wait(list(team))
            for pipe in (pipe for pipe in team if pipe in ready):
                driver, frames = _received(pipe)
                if frames:
                    taken(frames, driver)
                else:
                    busy += next_job(pipe) - 1


def _on_cluster(
    jobs: Sequence[DrawJob], sceneries: Mapping[str, Scenery], codec: str, crew: Crew, taken: Taken
) -> None:
    shared = (RECIPE, codec, crew.device, dict(sceneries))
    with cluster(str(crew.scheduler)) as workers:
        try:
            for _, (frames, driver) in workers.spread(draw_on_cluster, jobs, shared):
                taken(frames, driver)
        finally:
            workers.everywhere(stop_drawing)


def _received(pipe: Connection) -> tuple[str, list[DrawnFrame]]:
    with _living():
        result = pipe.recv()
    if isinstance(result, MachineError | InputError):
        raise result
    if isinstance(result, BaseException):
        raise RuntimeError(f"rendering failed: {result}") from result
    driver, frames = result
    return driver, frames


@contextmanager
def _living() -> Iterator[None]:
    """MachineError where the process at the other end of a pipe has died."""
    try:
        yield
    except (EOFError, OSError):
        raise MachineError(
            "rendering: a process died, as when memory runs out; the clips rendered so far are "
            "kept.\nRun it again, with --workers 1 where memory is short; `segue doctor` says more"
        ) from None


@contextmanager
def _started(count: int, codec: str, device: str) -> Iterator[tuple[Connection, ...]]:
    """Pipes to `count` workers, which end when the block does, killed if it fails."""
    context = multiprocessing.get_context("spawn")
    pipes: list[Any] = []  # of another type on each system
    processes = []
    with _environment(ENVIRONMENT):
        for _ in range(count):
            here, there = context.Pipe()
            process = context.Process(target=_work, args=(there, codec, device), daemon=True)
            process.start()
            there.close()
            pipes.append(here)
            processes.append(process)
    try:
        yield tuple(pipes)
        for pipe in pipes:
            with _living():
                pipe.send(None)
        for process in processes:
            process.join()
    finally:
        for process in processes:
            process.terminate()
        for process in processes:
            process.join()
        for pipe in pipes:
            pipe.close()


@contextmanager
def _environment(values: dict[str, str]) -> Iterator[None]:
    """Environment variables for children started within, put back afterwards."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _work(pipe: Connection, codec: str, device: str) -> None:
    """Draw what comes through the pipe until None comes, or nobody is left at its other end."""
    drawing, scenery = Drawing(codec, device), None
    try:
        while (sent := _next(pipe)) is not None:
            if isinstance(sent, Scenery):
                scenery = sent
            else:
                assert scenery is not None, "a scenery comes before its jobs"
                _draw(pipe, drawing, sent, scenery)
    except (BrokenPipeError, KeyboardInterrupt):
        return
    finally:
        drawing.close()


def _next(pipe: Connection) -> Scenery | DrawJob | None:
    try:
        sent = pipe.recv()
    except EOFError:
        return None
    assert sent is None or isinstance(sent, Scenery | DrawJob)
    return sent


def _draw(pipe: Connection, drawing: Drawing, job: DrawJob, scenery: Scenery) -> None:
    """The job's frames, some at a time, and none when it is done; or what went wrong."""
    ready: list[DrawnFrame] = []
    try:
        for frame in drawing.frames(job, scenery):
            ready.append(frame)
            if len(ready) == AT_ONCE:
                pipe.send((drawing.driver, ready))
                ready = []
    except (MachineError, InputError) as error:
        pipe.send(error)
    except (BrokenPipeError, KeyboardInterrupt):
        raise
    except Exception as error:
        pipe.send(RuntimeError(f"{type(error).__name__}: {error}"))
    else:
        if ready:
            pipe.send((drawing.driver, ready))
        pipe.send((drawing.driver, []))
