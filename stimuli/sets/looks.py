"""What lies beside masters for people who look: H.264 for browsers, glTF for other programs."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stimuli.motion.library import Library
from stimuli.processes import mapped
from stimuli.render.bodies import Body
from stimuli.render.gltf import write_glb
from stimuli.render.video import write_video
from stimuli.sets.group import plan_groups
from stimuli.sets.manifest import ClipEntry, Manifest
from stimuli.sets.masters import clip_frames
from stimuli.sets.spec import SetSpec

Told = Callable[[int, int], None]


@dataclass(frozen=True, eq=False)
class _Figure:
    path: Path
    body: Body
    bones: NDArray[np.float32]
    fps: float
    colour: tuple[float, float, float]


def write_web(manifest: Manifest, workers: int | None = None, told: Told | None = None) -> int:
    """An .mp4 beside each master that has none yet; returns how many were written.

    Their frames are the masters', in H.264 with colours tagged; `told(done, total)`.
    """
    entries = {entry.hash: entry for entry in manifest.clips}
    jobs = [(e, manifest.fps) for e in entries.values() if not _beside(e.path, ".mp4").exists()]
    for done, _ in enumerate(mapped(_web, jobs, workers, len(jobs)), 1):
        if told:
            told(done, len(jobs))
    return len(jobs)


def write_figures(
    manifest: Manifest,
    spec: SetSpec,
    library: Library,
    workers: int | None = None,
    told: Told | None = None,
) -> int:
    """A .glb beside each master that has none yet: its figure, moving; returns how many."""
    places = {entry.hash: _beside(entry.path, ".glb") for entry in manifest.clips}
    lacking = {name: path for name, path in places.items() if not path.exists()}
    jobs = {
        clip.hash: _Figure(
            lacking[clip.hash], group.body, clip.bones, spec.fps, spec.appearance.colour
        )
        for group in (plan_groups(spec, library) if lacking else ())
        for clip in group.clips
        if clip.hash in lacking
    }
    for done, _ in enumerate(mapped(_figure, list(jobs.values()), workers, len(jobs)), 1):
        if told:
            told(done, len(jobs))
    return len(jobs)


def _beside(path: Path, suffix: str) -> Path:
    return path.with_suffix(suffix)


def _web(job: tuple[ClipEntry, float]) -> None:
    entry, fps = job
    write_video(_beside(entry.path, ".mp4"), clip_frames(entry), fps)


def _figure(job: _Figure) -> None:
    write_glb(job.path, job.body, job.bones, job.fps, job.colour)
