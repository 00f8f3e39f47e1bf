"""One trial on a stage: its clips, its question, what came of it."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

from study.session.progress import Progress, advance, may_void, next_trial
from study.session.stage import Answer, Interrupted, Stage
from study.session.voids import VOID, VoidRule
from study.trials.observers import Simulated
from study.trials.plan import Plan
from study.trials.prompt import Prompt
from study.trials.tasks import Screens, Task, named_keys, pages_of
from study.trials.trial import ClipKey, Outcome, Trial

PAUSE = "Take a short break. Press {go_on} to go on."
AGAIN = "again"  # the answer that asks for a replay


class ShownClip(NamedTuple):
    """A clip as it is shown: the hash that names it, the first and last frame of its blend."""

    hash: str | None = None
    blend: tuple[int, int] | None = None


Clips = Callable[[ClipKey], ShownClip]


@dataclass(frozen=True)
class Settings:
    """How a session is shown: screen texts, answer window, what makes a trial void."""

    consent: str
    pages: tuple[str, ...]
    debriefing: str
    thanks: str
    pause: str
    answer_seconds: float | None
    is_void: VoidRule
    feedback: bool
    layout: str | None
    replays: int
    again: str
    replay: str
    feedback_texts: tuple[str, str]  # of a right answer and of a wrong one


def settings_of(plan: Plan, task: Task) -> Settings:
    """The protocol's settings, with the task's own where the protocol is silent."""
    file = plan.protocol.file
    seconds = file.presentation.answer_seconds or task.answer_seconds
    return Settings(
        consent=file.instructions.consent,
        pages=pages_of(file, task),
        debriefing=file.instructions.debriefing,
        thanks=file.instructions.thanks,
        pause=file.instructions.pause or PAUSE.format(**named_keys(file, task)),
        answer_seconds=seconds,
        is_void=partial(VOID[file.presentation.void], file.presentation.late_frames_allowed or 0),
        feedback=file.presentation.feedback_in_practice,
        replays=file.presentation.replays,
        again=file.keys.again,
        replay=file.instructions.replay,
        feedback_texts=(file.instructions.right, file.instructions.wrong),
        layout=None if file.presentation.layout == task.layout else file.presentation.layout,
    )


def show_trial(
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
    replays = 0
    while True:
        try:
            shown = stage.present(screens, f"trial {trial.number}")
            asked = _with_replay(question, settings, settings.replays - replays if screens else 0)
            answer = stage.ask(asked, settings.answer_seconds, planned)
        except Interrupted:
            stage.pause()
            continue
        if answer.response != AGAIN:
            break
        replays += 1
    bad = shown.late is not None and settings.is_void(
        shown.late, [[clips(key).blend for key in keys] for keys in screens]
    )
    outcome = Outcome(
        response=answer.response,
        response_time=answer.response_time,
        onset=shown.onset + since_first,
        late_frames=None if shown.late is None else sum(map(len, shown.late)),
        void=bad and may_void(progress, trial, card),
        replays=replays,
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


def _with_replay(prompt: Prompt, settings: Settings, left: int) -> Prompt:
    """The question with one more key, which shows the trial again, while some replays are left."""
    if left < 1:
        return prompt
    told = settings.replay.format(again=settings.again, left=left)
    return replace(
        prompt,
        text=f"{prompt.text}\n\n{told}",
        answers={**prompt.answers, settings.again: AGAIN},
    )


def show_example(stage: Stage, text: str, key: ClipKey) -> None:
    """A text, then the clip that it speaks of."""
    stage.tell(text)
    while True:
        try:
            stage.present(((key,),), f"example {key.motion}")
            return
        except Interrupted:
            stage.pause()
