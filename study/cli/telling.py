"""A line for the experimenter while a session runs: where it stands, how it was shown."""

import sys
import time
from typing import TextIO

from study.trials.trial import Outcome, Trial


class Teller:
    """Keeps one line on a terminal; says nothing where there is none."""

    def __init__(self, expected: int, stream: TextIO | None = None) -> None:
        self._expected = expected
        self._stream = stream or sys.stderr
        self._began = time.monotonic()
        self._late = self._void = 0

    def __call__(self, trial: Trial, outcome: Outcome) -> None:
        """Hear of a trial."""
        self._late += bool(outcome.late_frames)
        self._void += outcome.void
        if self._stream.isatty():
            self._stream.write(f"\r\x1b[K{self.line(trial, outcome)}")
            self._stream.flush()

    def line(self, trial: Trial, outcome: Outcome) -> str:
        """The line as it stands after a trial."""
        minutes, seconds = divmod(int(time.monotonic() - self._began), 60)
        answer = "no answer" if outcome.response is None else f"answer {outcome.response}"
        if outcome.response_time is not None:
            answer += f" after {outcome.response_time:.1f} s"
        parts = [
            f"trial {trial.number} of about {max(self._expected, trial.number)} ({trial.phase})",
            answer,
            f"{minutes}:{seconds:02d}",
        ]
        if self._late:
            parts.append(f"late frames in {self._late}, {self._void} asked again")
        return ", ".join(parts)

    def end(self) -> None:
        """Leave the line."""
        if self._stream.isatty():
            self._stream.write("\n")
