"""Drawing frames in a process that does nothing else, here or on a cluster."""

import hashlib
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

from stimuli.errors import InputError
from stimuli.render.video import MASTERS, Master, Packer
from stimuli.sets.frames import DrawJob, DrawnFrame, Scenery
from stimuli.sets.naming import RECIPE

if TYPE_CHECKING:
    from stimuli.render.scene import Renderer

ENVIRONMENT = {  # one core a process: more threads fight the software rasteriser
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "LP_NUM_THREADS": "0",
    "PYOPENGL_PLATFORM": "egl",
}


class Drawing:
    """One OpenGL context, kept while the look stays; belongs to the thread that draws first."""

    def __init__(self, codec: str, device: str) -> None:
        self.codec, self.device = codec, device
        self._renderer: Renderer | None = None
        self._shown: Scenery | None = None

    def frames(self, job: DrawJob, scenery: Scenery) -> Iterator[DrawnFrame]:
        """The job's frames, drawn, hashed and packed one by one."""
        renderer = self._at(scenery)
        pictures = (renderer.draw(job.bones, place, job.ground) for place in job.places)
        packer = Packer(self._master, *scenery.size)
        for key, picture in zip(job.keys, pictures, strict=True):
            yield DrawnFrame(key, packer.pack(picture), hashlib.sha256(picture.data).digest())

    @property
    def driver(self) -> str:
        """What drew the last frame; empty before the first."""
        return self._renderer.driver if self._renderer else ""

    @property
    def _master(self) -> Master:
        return MASTERS[self.codec]

    def _at(self, scenery: Scenery) -> "Renderer":
        from stimuli.render.scene import Renderer

        if self._renderer is None or self._renderer.look != scenery.look:
            self.close()
            self._renderer = Renderer(scenery.look, self.device)
        if self._shown is not scenery:
            self._renderer.show(scenery.skin, scenery.camera)
            self._shown = scenery
        return self._renderer

    def close(self) -> None:
        """Free the context; it must not outlive its process."""
        if self._renderer is not None:
            self._renderer.close()
        self._renderer = self._shown = None


_held: dict[tuple[str, str], Drawing] = {}
_threads: list[ThreadPoolExecutor] = []


def draw_on_cluster(
    job: DrawJob, shared: tuple[int, str, str, Mapping[str, Scenery]]
) -> tuple[list[DrawnFrame], str]:
    """The frames of a job, and what drew them; in a cluster's worker, whatever its threads.

    `shared` is the recipe, the codec, the device and the sceneries by name.
    """
    recipe, codec, device, sceneries = shared
    if recipe != RECIPE:
        raise InputError(
            f"--scheduler: expected workers whose Segue draws by recipe {recipe}, as this one, "
            f"found recipe {RECIPE}.\nInstall there what is installed here."
        )
    if not _threads:
        _threads.append(ThreadPoolExecutor(1))  # a context belongs to a thread
    return _threads[0].submit(_drawn, job, sceneries[job.scenery], codec, device).result()


def _drawn(job: DrawJob, scenery: Scenery, codec: str, device: str) -> tuple[list[DrawnFrame], str]:
    import os

    if not _held:
        os.environ.update(ENVIRONMENT)
    drawing = _held.setdefault((codec, device), Drawing(codec, device))
    frames = list(drawing.frames(job, scenery))
    return frames, drawing.driver


def stop_drawing() -> None:
    """Free what a cluster's worker drew with."""
    for thread in _threads:
        for drawing in _held.values():
            thread.submit(drawing.close).result()
        thread.shutdown()
    _held.clear()
    _threads.clear()
