"""One session: show, ask, record, advance, until the plan has no more trials."""

import warnings
from collections.abc import Callable, Iterable, Mapping
from datetime import UTC, datetime
from typing import Any

from stimuli.errors import InputError, InputWarning
from study.record.table import MISSING, Record, as_number, as_whole
from study.session.progress import Progress, advance, begin, next_trial, pause_due
from study.session.screening import catch_summary, practice_summary
from study.session.showing import Clips, Settings, settings_of, show_example, show_trial
from study.session.stage import Stage
from study.trials.observers import Simulated
from study.trials.plan import Plan, examples_of
from study.trials.tasks import Task
from study.trials.tracks import Tracks
from study.trials.trial import ClipKey, Outcome, Trial

TOO_SLOW = (
    "this machine is too slow: trials are shown late, and no more of them are asked again; "
    "close other programs, or render smaller clips"
)
LATE_BY_CLOCK = (
    "frames came late by the clock that paces this screen, which has no vertical blank (a virtual "
    "one has none), and no more trials are asked again; a lab's screen will tell its own"
)


def rows_of_plan(
    plan: Plan, stage: Stage, observer: Simulated, clips: Clips
) -> Iterable[tuple[Trial, dict[str, Any]]]:
    """A whole session of a simulated observer, trial by trial, without a record."""
    progress = begin(plan)
    settings = settings_of(plan, progress.task)
    while (step := show_trial(progress, stage, settings, observer, clips)) is not None:
        trial, outcome, progress, _ = step
        yield trial, row_of(progress.task, trial, outcome, clips)


def run(
    plan: Plan,
    stage: Stage,
    record: Record,
    observer: Simulated | None,
    clips: Clips,
    told: Callable[[Trial, Outcome], None] = lambda trial, outcome: None,
) -> Progress:
    """Run or go on with a session; every answer is on the disk before the next trial starts.

    Without an observer the stage's keyboard answers. `told` hears of each trial. Raises SessionLeft
    when somebody leaves; the record then holds all trials so far and is not finished.
    """
    progress = replay_rows(plan, record.rows())
    task = progress.task
    settings = settings_of(plan, task)
    earlier = record.sidecar.get("KeyTiming", [])
    _begin(plan, stage, record, settings, begun=bool(progress.number))
    _note_timing(record, stage, earlier)
    since_first = _since_first_flip(stage, record)
    while (step := show_trial(progress, stage, settings, observer, clips, since_first)) is not None:
        before = progress
        trial, outcome, progress, bad = step
        row = row_of(task, trial, outcome, clips)
        # A record that an earlier version began has its columns.
        record.append({key: value for key, value in row.items() if key in record.columns})
        told(trial, outcome)
        if bad and trial.phase == "main" and not outcome.void:
            _warn_when_slow(record)
        if trial.phase == "practice" and settings.feedback and task.catch:
            right = task.correct(trial.content, outcome.response)
            stage.flash(settings.feedback_texts[not right])
        if pause_due(before, progress) and next_trial(progress) is not None:
            stage.tell(settings.pause)
            _note_timing(record, stage, earlier)
    record.save_sidecar(
        Finished=True,
        **track_summary(progress),
        **practice_summary(progress),
        **catch_summary(progress),
    )
    if settings.debriefing:
        stage.tell(settings.debriefing)
    stage.thank(settings.thanks)
    return progress


def _begin(plan: Plan, stage: Stage, record: Record, settings: Settings, begun: bool) -> None:
    """Consent, instructions and examples; of a session that is gone on with, the last page."""
    if settings.consent and "Consent" not in record.sidecar:
        stage.tell(settings.consent)
        record.save_sidecar(Consent=datetime.now(UTC).isoformat(timespec="seconds"))
    for page in settings.pages[-1:] if begun else settings.pages:
        stage.tell(page)
    for text, key in () if begun else examples_of(plan):
        show_example(stage, text, key)


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
        clocked = record.sidecar.get("Display", {}).get("vsync") is False
        warnings.warn(LATE_BY_CLOCK if clocked else TOO_SLOW, InputWarning, stacklevel=2)


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
        "replays": outcome.replays,
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
