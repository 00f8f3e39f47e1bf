"""The window of a session: texts, clips by frame index, answers by key, every flip logged."""

import time
from collections import deque
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from stimuli.errors import UnwritableError
from study.protocol.schema import Instructions, Keys
from study.screen.clips import ClipSource, Showable
from study.screen.home import writable_home
from study.screen.keyboards import open_keyboard
from study.screen.markers import Mark, unmarked
from study.screen.panel import Panel
from study.screen.placing import shown_sizes, side_by_side
from study.screen.refresh import Refresh, refresh_of
from study.screen.scales import Clicks, Row, draw_scale
from study.screen.schedule import Due, frames_late, last_refresh, schedule
from study.screen.screens import open_on_screen
from study.session.stage import Answer, Interrupted, Presented, SessionLeft
from study.trials.prompt import Prompt
from study.trials.tasks import Screens

_INK = (-0.85, -0.85, -0.85)
READING_SECONDS = 1.5
SPIN_SECONDS = 0.002


@dataclass(frozen=True)
class Look:
    """How a window shows trials: keys, gap (s), the share of the window that clips may fill.

    `picture` is the size of the clips, `beside` how many a screen shows, for the record alone;
    `viewing_distance` and `screen_width` are in cm, a width of None being the system's to say.
    """

    keys: Keys
    gap: float
    clip_height: float
    fps: float
    background: tuple[int, int, int]
    pace: float = 1.0
    simulated: bool = False
    enlarge: bool = False
    viewing_distance: float = 57.0
    screen_width: float | None = None
    picture: tuple[int, int] | None = None
    beside: int = 1
    interrupted: str = Instructions().interrupted


class WindowStage:
    """A stage (see `study.session.stage`) in a PsychoPy window."""

    def __init__(
        self,
        look: Look,
        clips: ClipSource,
        flip_log: Path | None,
        screen: int = 0,
        windowed: bool = False,
        mark: Mark = unmarked,
    ) -> None:
        self._look, self._clips, self._flip_log = look, clips, flip_log
        self._mark, self._label = mark, ""
        with writable_home():
            self._window = open_on_screen(screen, windowed, look.background)
            self._keyboard = open_keyboard(self._window)
        self._refresh = refresh_of(self._window)
        self._paced = not self._refresh.vsync
        self._rate = self._refresh.rate
        self._panels: dict[tuple[int, int, tuple[int, ...]], Panel] = {}
        self._flips: deque[float] = deque([0.0], maxlen=15)  # seconds that the last ones took
        self._shown = False  # whether clips were, since the last question
        self._zero: float | None = None
        self._zero_wall: float | None = None

    @property
    def refresh(self) -> Refresh:
        """The rates of the screen."""
        return self._refresh

    def first_flip(self) -> float | None:
        """Unix time of this stage's first flip, None before it."""
        return self._zero_wall

    def display(self) -> dict[str, object]:
        """Size, refresh rate and keyboard of this window, for the sidecar."""
        return {
            "kind": "psychopy",
            "size": [int(v) for v in self._window.size],
            **self._refresh.facts(),
            "fullscreen": bool(self._window._isFullScr),
            "keyboard": self._keyboard.timing()["keyboard"],
            **self._clip_facts(),
        }

    def _clip_facts(self) -> dict[str, object]:
        look, picture = self._look, self._look.picture
        if picture is None:
            return {}
        placing = side_by_side(self._size(), picture, look.beside, look.clip_height, look.enlarge)
        screen = self._window.winHandle.screen
        shown = shown_sizes(placing, screen, look.screen_width, look.viewing_distance)
        return {"picture": dict(shown)}

    def _size(self) -> tuple[int, int]:
        width, height = (int(v) for v in self._window.size)
        return width, height

    def timing(self) -> dict[str, object]:
        """How the keys were timed in this window so far, for the sidecar."""
        return self._keyboard.timing()

    def tell(self, text: str) -> None:
        """Show a text until the go-on key; a simulated observer reads for a moment.

        A block comes after it, for which the keyboard's clock is measured.
        """
        while True:
            self._text(text)
            self._keyboard.measure()
            if self._look.simulated:
                self._wait(READING_SECONDS / self._look.pace)
                return
            self._keyboard.listen()
            try:
                self._await_key({self._look.keys.go_on: "on"}, None)
                return
            except Interrupted:
                self.pause()

    def pause(self) -> None:
        """Ask whether to go on; SessionLeft when the key that leaves is pressed once more."""
        keys = self._look.keys
        self._window.callOnFlip(self._keyboard.listen)
        self._text(self._look.interrupted.format(go_on=keys.go_on.upper(), quit=keys.quit.upper()))
        try:
            self._await_key({keys.go_on: "on"}, None)
        except Interrupted:
            raise SessionLeft from None
        self._keyboard.listen()

    def thank(self, text: str) -> None:
        """Show the last text until a key that goes on or leaves."""
        self._text(text)
        if self._look.simulated:
            self._wait(READING_SECONDS / self._look.pace)
            return
        self._keyboard.listen()
        with suppress(Interrupted):
            self._await_key({self._look.keys.go_on: "on"}, None)

    def flash(self, text: str) -> None:
        """Show a text for a moment."""
        self._text(text)
        self._wait(READING_SECONDS / 2 / self._look.pace)

    def present(self, screens: Screens, label: str) -> Presented:
        """Show each screen's clips in step; they are decoded from the moment it is announced."""
        look = self._look
        onset = 0.0 if self._zero is None else time.perf_counter() - self._zero
        self._label = label
        self._window.callOnFlip(self._mark, f"{label} start", 0.0)
        late: list[tuple[int, ...]] = []
        for n, keys in enumerate(screens):
            count = min(self._clips.count(key) for key in keys)
            dues = schedule(count, look.fps, self._rate, look.pace)
            begun = self._clips.start(keys, [due.frame for due in dues])
            self._text(str(n + 1) if len(screens) > 1 else "+")
            self._wait(look.gap / look.pace)
            self._leave_on_quit()
            self._shown = True
            start, slow = self._play([begun[key] for key in keys], dues, f"{label} screen {n + 1}")
            onset = start if n == 0 else onset
            late.append(slow)
        return Presented(onset, None if look.pace > 1 else tuple(late))

    def ask(self, question: Prompt, seconds: float | None, planned: Answer | None) -> Answer:
        """Put the question; keys count from the flip of the last frame on, else from its own."""
        self._window.callOnFlip(self._mark, f"{self._label} question", 0.0)
        given = self._asked(question, seconds, planned)
        ago = 0.0
        if planned is None and given.response_time is not None:
            ago = max(self._keyboard.since() - given.response_time, 0.0)
        self._mark(f"{self._label} answer {given.response or 'none'}", ago)
        return given

    def _asked(self, question: Prompt, seconds: float | None, planned: Answer | None) -> Answer:
        row = None
        if question.scale is not None:
            row = draw_scale(self._window, question.scale, tuple(question.answers))
        if not self._shown:
            self._window.callOnFlip(self._keyboard.listen)
        self._text(question.text, up=0.15 if row else 0.0)
        self._shown = False
        if planned is not None and planned.response_time is not None:
            taken = planned.response_time
            in_time = seconds is None or taken <= seconds
            self._wait((taken if in_time else seconds or 0.0) / self._look.pace)
            self._leave_on_quit()
            return planned if in_time else Answer(None, None)
        if row is None:
            return self._await_key(question.answers, seconds)
        with Clicks(self._window) as clicks:
            return self._await_key(question.answers, seconds, clicks, row)

    def picture(self) -> Any:
        """What the back buffer holds, as a PIL image; call it before a flip."""
        return self._window._getFrame(buffer="back")

    def close(self) -> None:
        """Close the window."""
        for panel in self._panels.values():
            panel.delete()
        self._clips.close()
        self._keyboard.close()
        self._window.close()

    def _play(
        self, clips: Sequence[Showable], dues: Sequence[Due], label: str
    ) -> tuple[float, tuple[int, ...]]:
        """Show clips together, each frame when it is due; the onset, and which came late."""
        look, size = self._look, self._size()
        width, height = clips[0].size
        panels = self._panels_for(len(clips), (height, width))
        for clip in clips:
            clip.ready()
        flips: list[float] = []
        self._window.callOnFlip(self._mark, label, 0.0)
        for due in dues:
            for panel, clip in zip(panels, clips, strict=True):
                panel.draw(clip.frame(due.frame), size)
            if due is dues[-1]:
                self._leave_on_quit()
                self._window.callOnFlip(self._keyboard.listen)
            if flips:
                self._sleep_until(flips[0] + due.refresh / self._rate)
            flips.append(self._flip())
        end = last_refresh(dues[-1].frame + 1, look.fps, self._rate, look.pace)
        self._sleep_until(flips[0] + end / self._rate)
        late = tuple(frames_late(dues, flips, self._rate))
        self._log(label, dues, flips)
        assert self._zero is not None
        return flips[0] - self._zero, late

    def _panels_for(self, count: int, shape: tuple[int, ...]) -> list[Panel]:
        look, picture = self._look, (shape[1], shape[0])
        placing = side_by_side(self._size(), picture, count, look.clip_height, look.enlarge)
        for n, centre in enumerate(placing.centres):
            if (count, n, shape) not in self._panels:
                self._panels[count, n, shape] = Panel(centre, placing.size)
        return [self._panels[count, n, shape] for n in range(count)]

    def _text(self, text: str, up: float = 0.0) -> None:
        from psychopy import visual

        height = self._window.size[1] / 30
        visual.TextStim(
            self._window,
            text=text,
            height=height,
            wrapWidth=0.8 * self._window.size[0],
            color=_INK,
            units="pix",
            alignText="center",
            pos=(0, up * self._window.size[1]),
        ).draw()
        self._flip()

    def _flip(self) -> float:
        begun = time.perf_counter()
        self._window.flip()
        now = time.perf_counter()
        self._flips.append(now - begun)
        if self._zero is None:
            self._zero, self._zero_wall = now, time.time()
        return now

    def _sleep_until(self, due: float) -> None:
        """Wait for a due flip: half a refresh before it, or as long as flips take where the screen
        waits for none."""
        at = due - (float(np.median(self._flips)) if self._paced else 0.5 / self._rate)
        rest = at - time.perf_counter() - SPIN_SECONDS
        if rest > 0:
            time.sleep(rest)
        while time.perf_counter() < at:
            pass

    def _wait(self, seconds: float) -> None:
        end = time.perf_counter() + seconds
        while (rest := end - time.perf_counter()) > 0:
            time.sleep(min(rest, 0.05))
            self._window.winHandle.dispatch_events()

    def _leave_on_quit(self) -> None:
        """Interrupted when the key that pauses or leaves was pressed."""
        if self._keyboard.pressed([self._look.keys.quit], clear=False):
            raise Interrupted

    def _await_key(
        self,
        meanings: Mapping[str, str],
        seconds: float | None,
        clicks: Clicks | None = None,
        row: Row | None = None,
    ) -> Answer:
        """The first of the keys pressed since keys count, within seconds of the last frame.

        A click on a point of `row` answers too, timed when it is seen.
        """
        wanted = [*meanings, self._look.keys.quit]
        while seconds is None or self._keyboard.since() < seconds:
            for key in self._keyboard.pressed(wanted):
                if key.name == self._look.keys.quit:
                    raise Interrupted
                if seconds is None or key.seconds <= seconds:
                    return Answer(meanings[key.name], key.seconds)
            if clicks is not None and row is not None:
                for place in clicks.taken():
                    if (point := row.at(*place)) is not None:
                        return Answer(point, self._keyboard.since())
            time.sleep(0.002)
            self._window.winHandle.dispatch_events()
        return Answer(None, None)

    def _log(self, label: str, dues: Sequence[Due], flips: Sequence[float]) -> None:
        if self._flip_log is None:
            return
        assert self._zero is not None
        assert self._zero_wall is not None
        to_wall = self._zero_wall - self._zero
        lines = [
            f"{label}\t{due.frame}\t{due.refresh / self._rate:.6f}\t{flip - flips[0]:.6f}"
            f"\t{flip + to_wall:.6f}\n"
            for due, flip in zip(dues, flips, strict=True)
        ]
        new = not self._flip_log.exists()
        try:
            with self._flip_log.open("a", encoding="utf-8") as stream:
                if new:
                    stream.write("trial\tframe\tdue\tflip\tunix_time\n")
                stream.writelines(lines)
        except OSError as error:
            raise UnwritableError(
                f"{self._flip_log}: the flips of {label} could not be written: "
                f"{error.strerror or error}"
            ) from error
