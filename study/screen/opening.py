"""From a session's request to its window: which clips, which keys, what background."""

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

from stimuli.errors import InputError, InputWarning
from study.screen.clips import ClipCache
from study.screen.lost import tell_when_lost
from study.screen.refresh import notes_on
from study.screen.window import Look, WindowStage
from study.session.lab import Request, clips_of, entry, shown_frames
from study.trials.plan import Plan
from study.trials.tasks import Task

if TYPE_CHECKING:
    from stimuli.sets import Manifest


def open_window(
    request: Request, plan: Plan, task: Task, manifest: "Manifest", flip_log: Path
) -> WindowStage:
    """The window of a session, open, its background that of the clips."""
    from stimuli.sets.video import read_clip

    file = plan.protocol.file
    start, count = shown_frames(plan, manifest)
    clips = ClipCache(lambda key: read_clip(entry(manifest, key))[start : start + count])
    first = clips_of(plan)[0]
    corner = clips.frames([first])[first][0, 0, 0]
    look = Look(
        keys=file.keys,
        gap=file.presentation.gap,
        clip_height=file.presentation.clip_height,
        fps=float(manifest.fps),
        background=(int(corner[0]), int(corner[1]), int(corner[2])),
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
