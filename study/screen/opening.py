"""From a session's request to its window: which clips, which keys, what background."""

from pathlib import Path
from typing import TYPE_CHECKING

from study.screen.clips import ClipCache, Frames
from study.screen.lost import tell_when_lost
from study.screen.window import Look, WindowStage
from study.session.lab import Request, clips_of, entry
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
    seconds = min(file.rehearsal.seconds, manifest.seconds) if plan.rehearsal else manifest.seconds
    count = round(seconds * manifest.fps)
    clips = ClipCache(lambda key: middle_of(read_clip(entry(manifest, key)), count))
    first = clips_of(plan)[0]
    corner = clips.frames([first])[first][0, 0, 0]
    look = Look(
        keys=file.keys,
        responses=task.responses,
        gap=file.presentation.gap,
        clip_height=file.presentation.clip_height,
        fps=float(manifest.fps),
        background=(int(corner[0]), int(corner[1]), int(corner[2])),
        pace=request.pace,
        simulated=request.observer == "simulated",
    )
    stage = WindowStage(look, clips, flip_log, request.screen, request.windowed)
    tell_when_lost(request.lost)
    return stage


def middle_of(frames: Frames, count: int) -> Frames:
    """`count` of a clip's frames (F, H, W, 3) around its middle, where the transition is."""
    first = max((len(frames) - count) // 2, 0)
    return frames[first : first + count]
