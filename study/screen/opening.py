"""From a session's request to its window: which clips, which keys, what background."""

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stimuli.errors import InputError, InputWarning
from study.screen.clips import ClipCache, Frames
from study.screen.lost import tell_when_lost
from study.screen.refresh import notes_on
from study.screen.window import Look, WindowStage
from study.session.lab import Request, entry, shown_frames
from study.trials.plan import Plan
from study.trials.tasks import Task

if TYPE_CHECKING:
    from stimuli.sets import Manifest


def open_window(
    request: Request, plan: Plan, task: Task, manifest: "Manifest", flip_log: Path
) -> WindowStage:
    """The window of a session, open, its background that of the clips."""
    file = plan.protocol.file
    start, count = shown_frames(plan, manifest)
    clips = ClipCache(lambda key: _whole(entry(manifest, key))[start : start + count])
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
    )
    stage = WindowStage(look, clips, flip_log, request.screen, request.windowed)
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


def _whole(clip: Any) -> Frames:
    """The frames of a clip of the manifest; InputError where some are missing."""
    from stimuli.sets.video import decode_video

    frames = decode_video(clip.path)
    if len(frames) != clip.frames:
        raise InputError(
            f"{clip.path}: expected {clip.frames} frames, found {len(frames)}: it was cut short.\n"
            "Build the stimulus set again with segue render"
        )
    return frames
