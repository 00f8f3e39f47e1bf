"""From a session's request to its window: which clips, which keys, what background."""

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

from stimuli.errors import InputError, InputWarning
from study.screen.clips import ClipFile, Decoder
from study.screen.lost import tell_when_lost
from study.screen.refresh import notes_on
from study.screen.window import Look, WindowStage
from study.session.lab import Request, clips_of, entry, shown_frames
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

    corner = _corner(lies(clips_of(plan)[0]))
    look = Look(
        keys=file.keys,
        gap=file.presentation.gap,
        clip_height=file.presentation.clip_height,
        fps=float(manifest.fps),
        background=corner,
        pace=request.pace,
        simulated=request.observer == "simulated",
        interrupted=file.instructions.interrupted,
    )
    clips = Decoder(lies)
    try:
        stage = WindowStage(look, clips, flip_log, request.screen, request.windowed)
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


def _corner(clip: ClipFile) -> tuple[int, int, int]:
    """The background of a clip: the corner of its first frame."""
    from stimuli.render.video import wanted_frames
    from stimuli.sets.masters import clip_content

    content = clip_content(clip.path, clip.sha256)
    frame = next(wanted_frames(clip.path, content, [0], clip.whole))
    red, green, blue = (int(value) for value in frame[0, 0])
    return red, green, blue
