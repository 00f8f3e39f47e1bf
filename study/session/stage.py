"""Where a session is shown: the interface of a stage, and the stage that has no window.

`study.screen.window` has the real one. Both get their answers from whoever answers: a person at
the keyboard, or a simulated observer whose answer is planned before the question is shown.
"""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

from study.trials.prompt import Prompt
from study.trials.tasks import Screens


class Presented(NamedTuple):
    """When the trial's first frame was flipped (seconds, stage clock), and the clip frames that
    came late on each screen; None where time runs faster and frames are left out on purpose."""

    onset: float
    late: tuple[tuple[int, ...], ...] | None


class Answer(NamedTuple):
    """A response and the seconds from the last frame to it; None: no answer in time."""

    response: str | None
    response_time: float | None


class Interrupted(Exception):
    """Somebody pressed the key that pauses or leaves; the trial on screen is shown again."""


class SessionLeft(Exception):
    """The participant or experimenter left the session; its record stays and can be resumed."""


class ScreenLostError(Exception):
    """The screen went away; the record stays and can be resumed."""


class Stage(Protocol):
    """What a session needs of the place where it is shown."""

    def tell(self, text: str) -> None:
        """Show a text until it is dismissed; raises SessionLeft."""

    def pause(self) -> None:
        """Ask whether to go on or to leave; raises SessionLeft when leaving is confirmed."""

    def thank(self, text: str) -> None:
        """Show the last text; whichever key is pressed, the session is over."""

    def flash(self, text: str) -> None:
        """Show a text for a moment."""

    def present(self, screens: Screens, label: str) -> Presented:
        """Show the clips of each screen together, the screens one after the other. Or Interrupted.

        Without screens nothing is shown, and the onset is that of the question.
        """

    def ask(self, question: Prompt, seconds: float | None, planned: Answer | None) -> Answer:
        """Ask; wait for a key, or for the time that the planned answer takes. Or Interrupted."""

    def first_flip(self) -> float | None:
        """Unix time of the stage's first flip; None where nothing is flipped."""

    def display(self) -> dict[str, object]:
        """What the stage is, for the sidecar."""

    def timing(self) -> dict[str, object]:
        """How answers were timed so far, for the sidecar; nothing where nobody presses keys."""

    def close(self) -> None:
        """Give the stage up."""


@dataclass
class Nowhere:
    """A stage without a window: time passes by addition only, and every answer is planned."""

    clip_seconds: float
    gap: float
    clock: float = 0.0

    def tell(self, text: str) -> None:
        """Nobody reads."""

    def pause(self) -> None:
        """Nobody interrupts."""

    def thank(self, text: str) -> None:
        """Nobody reads."""

    def flash(self, text: str) -> None:
        """Nobody reads."""

    def present(self, screens: Screens, label: str) -> Presented:
        """Advance the clock by the clips and the gaps between them."""
        onset = self.clock
        self.clock += len(screens) * self.clip_seconds + max(len(screens) - 1, 0) * self.gap
        return Presented(onset, ())

    def ask(self, question: Prompt, seconds: float | None, planned: Answer | None) -> Answer:
        """Take the planned answer, unless it comes too late."""
        if planned is None or planned.response_time is None:
            raise ValueError("a stage without a window needs a planned answer")
        if seconds is not None and planned.response_time > seconds:
            self.clock += seconds
            return Answer(None, None)
        self.clock += planned.response_time
        return planned

    def first_flip(self) -> float | None:
        """Nothing is flipped, and no wall clock enters the record."""
        return None

    def display(self) -> dict[str, object]:
        """No display."""
        return {"kind": "none"}

    def timing(self) -> dict[str, object]:
        """No key is pressed."""
        return {}

    def close(self) -> None:
        """Nothing to close."""
