"""One session: show, ask, record, advance, until the plan has no more trials."""

import warnings
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

from stimuli.errors import InputError, InputWarning
from study.record.table import MISSING, Record, as_number, as_whole
from study.session.progress import Progress, advance, begin, may_void, next_trial, pause_due
from study.session.stage import Answer, Interrupted, Stage
from study.session.voids import VOID, VoidRule
from study.trials.observers import Simulated
from study.trials.plan import Plan, examples_of
from study.trials.tasks import Screens, Task, named_keys, welcome_of
from study.trials.tracks import Tracks
from study.trials.trial import ClipKey, Outcome, Trial

TOO_SLOW = (
    "this machine is too slow: trials are shown late, and no more of them are asked again; "
    "close other programs, or render smaller clips"
)
PAUSE = "Take a short break. Press {go_on} to go on."
CORRECT, WRONG = "right", "not this time"


class ShownClip(NamedTuple):
    """A clip as it is shown: the hash that names it, the first and last frame of its blend."""

    hash: str | None = None
    blend: tuple[int, int] | None = None


Clips = Callable[[ClipKey], ShownClip]


@dataclass(frozen=True)
class Settings:
    """How a session is shown: screen texts, answer window, what makes a trial void."""

    welcome: str
    thanks: str
    pause: str
    answer_seconds: float | None
    is_void: VoidRule
    feedback: bool
    layout: str | None


def settings_of(plan: Plan, task: Task) -> Settings:
    """The protocol's settings, with the task's own where the protocol is silent."""
    file = plan.protocol.file
    seconds = file.presentation.answer_seconds or task.answer_seconds
    return Settings(
        welcome=welcome_of(file, task),
        thanks=file.instructions.thanks,
        pause=file.instructions.pause or PAUSE.format(**named_keys(file, task)),
        answer_seconds=seconds,
        is_void=partial(VOID[file.presentation.void], file.presentation.late_frames_allowed or 0),
        feedback=file.presentation.feedback_in_practice,
        layout=None if file.presentation.layout == task.layout else file.presentation.layout,
    )


def rows_of_plan(
    plan: Plan, stage: Stage, observer: Simulated, clips: Clips
) -> Iterable[tuple[Trial, dict[str, Any]]]:
    """A whole session of a simulated observer, trial by trial, without a record."""
    progress = begin(plan)
    settings = settings_of(plan, progress.task)
    while (step := _trial(progress, stage, settings, observer, clips)) is not None:
        trial, outcome, progress, _ = step
        yield trial, row_of(progress.task, trial, outcome, clips)


def run(
    plan: Plan,
    stage: Stage,
    record: Record,
    observer: Simulated | None,
    clips: Clips,
) -> Progress:
    """Run or go on with a session; every answer is on the disk before the next trial starts.

    Without an observer the stage's keyboard answers. Raises SessionLeft when somebody leaves; the
    record then holds all trials so far and is not finished.
    """
    progress = replay_rows(plan, record.rows())
    task = progress.task
    settings = settings_of(plan, task)
    earlier = record.sidecar.get("KeyTiming", [])
    stage.tell(settings.welcome)
    if not progress.number:
        for text, key in examples_of(plan):
            _example(stage, text, key)
    _note_timing(record, stage, earlier)
    since_first = _since_first_flip(stage, record)
    while (step := _trial(progress, stage, settings, observer, clips, since_first)) is not None:
        before = progress
        trial, outcome, progress, bad = step
        record.append(row_of(task, trial, outcome, clips))
        if bad and trial.phase == "main" and not outcome.void:
            _warn_when_slow(record)
        if trial.phase == "practice" and settings.feedback and task.catch:
            right = task.correct(trial.content, outcome.response)
            stage.flash(CORRECT if right else WRONG)
        if pause_due(before, progress) and next_trial(progress) is not None:
            stage.tell(settings.pause)
            _note_timing(record, stage, earlier)
    record.save_sidecar(Finished=True, **track_summary(progress))
    stage.thank(settings.thanks)
    return progress


def _example(stage: Stage, text: str, key: ClipKey) -> None:
    """A text, then the clip that it speaks of."""
    stage.tell(text)
    while True:
        try:
            stage.present(((key,),), f"example {key.motion}")
            return
        except Interrupted:
            stage.pause()


def _trial(
    progress: Progress,
    stage: Stage,
    settings: Settings,
    observer: Simulated | None,
    clips: Clips,
    since_first: float = 0.0,
) -> tuple[Trial, Outcome, Progress, bool] | None:
    """Show one trial and take its answer; says too whether it was shown too badly to count."""
    drawn = next_trial(progress)
    if drawn is None:
        return None
    trial, card = drawn
    planned = None
    if observer is not None:
        generator = progress.plan.generator(3, trial.number)
        planned = Answer(*observer.answer(trial.content, generator))
    screens = arrange(progress.task.screens(trial.content), settings.layout)
    question = progress.task.ask(progress.plan.protocol.file, trial.content)
    while True:
        try:
            shown = stage.present(screens, f"trial {trial.number}")
            answer = stage.ask(question, settings.answer_seconds, planned)
            break
        except Interrupted:
            stage.pause()
    bad = shown.late is not None and settings.is_void(
        shown.late, [[clips(key).blend for key in keys] for keys in screens]
    )
    outcome = Outcome(
        response=answer.response,
        response_time=answer.response_time,
        onset=shown.onset + since_first,
        late_frames=None if shown.late is None else sum(map(len, shown.late)),
        void=bad and may_void(progress, trial, card),
    )
    return trial, outcome, advance(progress, trial, card, outcome), bad


def arrange(screens: Screens, layout: str | None) -> Screens:
    """The task's screens, or where a protocol says so all clips together or one by one."""
    clips = tuple(clip for screen in screens for clip in screen)
    layouts = {
        None: screens,
        "side-by-side": (clips,),
        "one-after-other": tuple((clip,) for clip in clips),
    }
    return layouts[layout]


def _note_timing(record: Record, stage: Stage, earlier: list[Any]) -> None:
    """How this stage times keys, block by block, after what `earlier` stages did."""
    if timing := stage.timing():
        record.save_sidecar(KeyTiming=[*earlier, timing])


def _since_first_flip(stage: Stage, record: Record) -> float:
    """Seconds from the session's first flip, on whatever day it was, to this stage's."""
    flipped = stage.first_flip()
    if flipped is None:
        return 0.0
    if "FirstFlip" not in record.sidecar:
        record.save_sidecar(FirstFlip=flipped)
    return flipped - float(record.sidecar["FirstFlip"])


def _warn_when_slow(record: Record) -> None:
    """Say once, aloud and in the sidecar, that late trials are no longer asked again."""
    if not record.sidecar.get("TooSlow"):
        record.save_sidecar(TooSlow=True)
        warnings.warn(TOO_SLOW, InputWarning, stacklevel=2)


def row_of(task: Task, trial: Trial, outcome: Outcome, clips: Clips) -> dict[str, Any]:
    """A row of the record."""
    shown = [clips(key).hash for key in task.clips(trial.content)]
    first, second = [*shown, None, None][:2]
    named = task.row(trial.content, outcome)
    return {
        "trial": trial.number,
        "phase": trial.phase,
        "repeat_of": trial.repeat_of,
        "onset": outcome.onset,
        "response": outcome.response,
        "response_time": outcome.response_time,
        "late_frames": outcome.late_frames,
        "void": outcome.void,
        "clip_a": first,
        "clip_b": second,
        **{
            key: (clips(value).hash or value.called) if isinstance(value, ClipKey) else value
            for key, value in named.items()
        },
    }


def replay_rows(plan: Plan, rows: Iterable[Mapping[str, str]]) -> Progress:
    """The session that a record's rows leave; each row must be the trial that the plan gives.

    Raises InputError naming the first row that is not.
    """
    progress = begin(plan)
    for n, row in enumerate(rows, start=1):
        drawn = next_trial(progress)
        outcome = _outcome(row)
        expected = None
        if drawn is not None:
            trial, card = drawn
            expected = progress.task.row(trial.content, outcome)
            found = {key: row.get(key, "") for key in expected}
            if as_whole(row["trial"]) == trial.number and _same(expected, found):
                progress = advance(progress, trial, card, outcome)
                continue
        raise InputError(
            f"row {n} of the record is not the trial that its seed gives (expected {expected}); "
            "the record was edited: start a new run with --restart"
        )
    return progress


def _same(expected: Mapping[str, object], found: Mapping[str, str]) -> bool:
    return all(
        found[k] == (MISSING if v is None else str(v))
        for k, v in expected.items()
        if not isinstance(v, ClipKey)  # which the record names by its hash
    )


def _outcome(row: Mapping[str, str]) -> Outcome:
    return Outcome(
        response=None if row["response"] == "n/a" else row["response"],
        response_time=as_number(row["response_time"]),
        onset=as_number(row["onset"]) or 0.0,
        late_frames=as_whole(row["late_frames"]),
        void=row["void"] == "1",
    )


def track_summary(progress: Progress) -> dict[str, Any]:
    """How each staircase ended, for the sidecar; nothing where the study has none."""
    if not isinstance(progress.supply, Tracks):
        return {}
    return {
        "Tracks": {
            f"{motion}/{side}": {
                "trials": len(track.answers),
                "stopped_by": track.stopped_by,
                "last_level": track.answers[-1][0] if track.answers else None,
                "ended_at_edge": track.ended_at_edge,
                "reversals": list(track.reversals),
            }
            for (motion, side), track in progress.supply.tracks.items()
        }
    }
