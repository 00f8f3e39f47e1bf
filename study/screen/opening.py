"""From a session's request to its window: which clips, which keys, what background."""

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

from stimuli.errors import InputError, InputWarning
from study.screen.clips import ClipFile, Decoder
from study.screen.lost import tell_when_lost
from study.screen.markers import Mark, open_markers, unmarked
from study.screen.refresh import notes_on
from study.screen.window import Look, WindowStage
from study.session.lab import Request, entry, shown_frames
from study.trials.plan import Plan
from study.trials.tasks import Task
from study.trials.trial import ClipKey

if TYPE_CHECKING:
    from stimuli.sets import Manifest


def open_window(
    request: Request, plan: Plan, task: Task, manifest: "Manifest", flip_log: Path
) -> WindowStage:
    """The window of a session, open, its background that of the clips."""
    file = plan.protocol.file
    start, count = shown_frames(plan, manifest)

    def lies(key: ClipKey) -> ClipFile:
        clip = entry(manifest, key)
        told = clip.document.get("file_sha256")
        return ClipFile(clip.path, told, clip.frames, start, count, *manifest.size)

    look = Look(
        keys=file.keys,
        gap=file.presentation.gap,
        clip_height=file.presentation.clip_height,
        fps=float(manifest.fps),
        background=levels(manifest.background),
        enlarge=file.presentation.enlarge,
        viewing_distance=file.presentation.viewing_distance,
        screen_width=file.presentation.screen_width,
        picture=manifest.size,
        beside=file.beside,
        pace=request.pace,
        simulated=request.observer == "simulated",
        interrupted=file.instructions.interrupted,
        photodiode=file.presentation.photodiode,
    )
    mark: Mark = unmarked
    if file.presentation.markers:
        mark = open_markers(f"segue-{flip_log.stem.removesuffix('_flips')}")
    clips = Decoder(lies)
    try:
        stage = WindowStage(look, clips, flip_log, request.screen, request.windowed, mark)
    except BaseException:
        clips.close()
        raise
    try:
        allowed = file.presentation.slow_screen_allowed
        for note in notes_on(stage.refresh, look.fps, allowed, look.pace):
            warnings.warn(note, InputWarning, stacklevel=2)
    except InputError:
        stage.close()
        raise
    tell_when_lost(request.lost)
    return stage


def levels(colour: tuple[float, float, float]) -> tuple[int, int, int]:
    """A colour 0..1 as pictures have it, in levels of 255."""
    red, green, blue = (round(255 * share) for share in colour)
    return red, green, blue
