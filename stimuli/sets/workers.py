"""Processes that render clips, one a core, each with one OpenGL context.

A worker is spawned, not forked, with one BLAS thread (more fight the software rasteriser), and
talks over a pipe: when the process that started it dies, the pipe closes and the worker ends.
"""

import hashlib
import multiprocessing
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stimuli.errors import MachineError, UnwritableError
from stimuli.files import NO_ROOM
from stimuli.render.appearance import Appearance
from stimuli.render.camera import Camera
from stimuli.render.ground import GroundMotion
from stimuli.render.skin import Skin

ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "LP_NUM_THREADS": "0",
    "PYOPENGL_PLATFORM": "egl",
}


@dataclass(frozen=True, eq=False)
class RenderJob:
    """A clip to render: how a skin's bones (F, B, 8) move, seen by a camera."""

    path: Path
    skin: Skin
    bones: NDArray[np.float32]
    fps: float
    camera: Camera
    look: Appearance
    ground: GroundMotion | None = None


@dataclass(frozen=True)
class Rendered:
    """A clip that was rendered: how many frames, and the SHA-256 of their RGB bytes in order.

    Another machine's rasteriser may shade the edge of a figure otherwise, so that this hash tells
    whether a file was damaged, not whether two clips are one: their names do.
    """

    path: Path
    frames: int
    frames_sha256: str


def render_all(
    jobs: Sequence[RenderJob], workers: int | None, done: Callable[[Rendered], None]
) -> None:
    """Render jobs in `workers` processes (default: all cores); `done` is called for each.

    MachineError or RuntimeError when a worker fails or dies; clips rendered before stay.
    """
    count = min(workers or os.cpu_count() or 1, len(jobs))
    with _started(count) as team:
        waiting = list(reversed(jobs))
        busy = 0
        for pipe in team:
            pipe.send(waiting.pop())
            busy += 1
        while busy:
            ready = wait(list(team))
            for pipe in (pipe for pipe in team if pipe in ready):
                result = _received(pipe)
                busy -= 1
                if waiting:
                    pipe.send(waiting.pop())
                    busy += 1
                done(result)


def _received(pipe: Connection) -> Rendered:
    try:
        result = pipe.recv()
    except EOFError:
        raise MachineError(
            "rendering: a process died, as when memory runs out; the clips rendered so far are "
            "kept.\nRun it again, with --workers 1 where memory is short; `segue doctor` says more"
        ) from None
    if isinstance(result, MachineError):
        raise result
    if isinstance(result, BaseException):
        raise RuntimeError(f"rendering failed: {result}") from result
    assert isinstance(result, Rendered)
    return result


@contextmanager
def _started(count: int) -> Iterator[tuple[Connection, ...]]:
    """Pipes to `count` workers, which end when the block does, killed if it fails."""
    context = multiprocessing.get_context("spawn")
    pipes: list[Any] = []  # of another type on each system
    processes = []
    with _environment(ENVIRONMENT):
        for _ in range(count):
            here, there = context.Pipe()
            process = context.Process(target=_work, args=(there,), daemon=True)
            process.start()
            there.close()
            pipes.append(here)
            processes.append(process)
    try:
        yield tuple(pipes)
        for pipe in pipes:
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


def _work(pipe: Connection) -> None:
    """Render what comes through the pipe until None comes, or nobody is left at its other end."""
    from stimuli.render.scene import Renderer

    drawing: Renderer | None = None
    try:
        while True:
            job = _next(pipe)
            if job is None:
                return
            if drawing is None or drawing.look != job.look:
                if drawing is not None:
                    drawing.close()
                    drawing = None
                drawing = Renderer(job.look)
            pipe.send(_outcome(job, drawing))
    except (BrokenPipeError, KeyboardInterrupt):
        return
    except MachineError as error:
        pipe.send(error)
    finally:
        if drawing is not None:
            drawing.close()


def _next(pipe: Connection) -> RenderJob | None:
    try:
        job = pipe.recv()
    except EOFError:
        return None
    assert job is None or isinstance(job, RenderJob)
    return job


def _outcome(job: RenderJob, drawing: Any) -> Rendered | BaseException:
    """The clip's frames written and hashed, or what went wrong."""
    from stimuli.render.video import write_video

    sha = hashlib.sha256()

    def frames() -> Iterator[Any]:
        for frame in drawing.frames(job.bones, job.ground):
            sha.update(frame.tobytes())
            yield frame

    try:
        drawing.show(job.skin, job.camera)
        count = write_video(job.path, frames(), job.fps)
    except Exception as error:
        if isinstance(error, UnwritableError):
            return _unwritten(job.path, error)
        return RuntimeError(f"{job.path.name}: {type(error).__name__}: {error}")
    return Rendered(job.path, count, sha.hexdigest())


def _unwritten(path: Path, error: UnwritableError) -> MachineError:
    """A clip that could not be written; those rendered so far are kept."""
    cause = error.__cause__
    why = getattr(cause, "strerror", None) or cause
    if isinstance(cause, OSError) and cause.errno in NO_ROOM:
        return MachineError(
            f"{path.parent}: expected room for a clip, found none ({why}); the clips rendered so "
            "far are kept.\nMake room on that disk, and run it again"
        )
    return MachineError(
        f"{path}: expected a place for a clip, found: {why}; the clips rendered so far are "
        "kept.\nMend that, and run it again"
    )
