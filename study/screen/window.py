"""The window of a session: texts, clips by frame index, answers by key, every flip logged."""

import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from study.protocol.schema import Instructions, Keys
from study.screen.clips import ClipSource, Showable
from study.screen.fliplog import log_flips
from study.screen.home import writable_home
from study.screen.keyboards import open_keyboard
from study.screen.markers import Mark, unmarked
from study.screen.panel import Panel
from study.screen.photodiode import Patch
from study.screen.placing import shown_sizes, side_by_side
from study.screen.playing import WindowFlips, play
from study.screen.refresh import Refresh, refresh_of
from study.screen.scales import Clicks, Row, draw_scale
from study.screen.schedule import Due, frames_late, last_refresh, schedule
from study.screen.screens import open_on_screen
from study.screen.texts import Writer
from study.session.stage import Answer, Interrupted, Presented, SessionLeft
from study.trials.prompt import Prompt
from study.trials.tasks import Screens

READING_SECONDS = 1.5


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
    photodiode: str | None = None


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
        self._writer = Writer(self._window, look.screen_width)
        self._patch = Patch(look.photodiode, self._size()) if look.photodiode else None
        self._refresh = refresh_of(self._window)
        self._flips = WindowFlips(self._window, self._refresh, self._patch)
        self._panels: dict[tuple[int, int, tuple[int, ...]], Panel] = {}
        self._shown = False  # whether clips were, since the last question

    @property
    def refresh(self) -> Refresh:
        """The rates of the screen."""
        return self._refresh

    def first_flip(self) -> float | None:
        """Unix time of this stage's first flip, None before it."""
        return self._flips.zero_wall

    def display(self) -> dict[str, object]:
        """Size, refresh rate and keyboard of this window, for the sidecar."""
        return {
            "kind": "psychopy",
            "size": [int(v) for v in self._window.size],
            **self._refresh.facts(),
            "fullscreen": bool(self._window._isFullScr),
            "keyboard": self._keyboard.timing()["keyboard"],
            **({"photodiode": self._patch.facts()} if self._patch else {}),
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
        """Show a text, in parts where it is long, each until the go-on key; a simulated observer
        reads for a moment.

        A block comes after it, for which the keyboard's clock is measured.
        """
        pages = self._writer.pages(text)
        for number, page in enumerate(pages, start=1):
            self._tell(page, number, len(pages))

    def _tell(self, page: str, number: int, count: int) -> None:
        keys = self._look.keys
        while True:
            self._writer.draw_page(page, number, count, keys.go_on.upper())
            self._flip()
            self._keyboard.measure()
            if self._look.simulated:
                self._wait(READING_SECONDS / self._look.pace)
                return
            self._keyboard.listen()
            try:
                self._await_key({keys.go_on: "on"}, None)
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
        onset = 0.0 if self._flips.zero is None else self._flips.now() - self._flips.zero
        self._label = label
        self._window.callOnFlip(self._mark, f"{label} start", 0.0)
        late: list[tuple[int, ...]] = []
        for n, keys in enumerate(screens):
            count = min(self._clips.count(key) for key in keys)
            dues = schedule(count, look.fps, self._flips.rate, look.pace)
            begun = self._clips.start(keys, [due.frame for due in dues])
            self._text(str(n + 1) if len(screens) > 1 else "+")
            self._wait(look.gap / look.pace)
            self._leave_on_quit()
            self._shown = True
            start, slow = self._play([begun[key] for key in keys], dues, label, n + 1)
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
            keys = tuple(question.answers)[: len(question.scale.points)]  # that of a replay is last
            row = draw_scale(self._window, self._writer, question.scale, keys)
        if not self._shown:
            self._window.callOnFlip(self._keyboard.listen)
        self._text(question.text, low=row.top if row else None)
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
        if self._patch:
            self._patch.delete()
        self._clips.close()
        self._keyboard.close()
        self._window.close()

    def _play(
        self, clips: Sequence[Showable], dues: Sequence[Due], label: str, screen: int
    ) -> tuple[float, tuple[int, ...]]:
        """Show clips together, each frame when it is due; the onset, and which came late."""
        look, size, rate = self._look, self._size(), self._flips.rate
        width, height = clips[0].size
        panels = self._panels_for(len(clips), (height, width))
        for clip in clips:
            clip.ready()

        def draw(place: int) -> None:
            for panel, clip in zip(panels, clips, strict=True):
                panel.fill(clip.frame(dues[place].frame))
            if self._patch:
                self._patch.frame(place)
            again()
            if place == len(dues) - 1:
                self._leave_on_quit()
                self._window.callOnFlip(self._keyboard.listen)

        def again() -> None:
            for panel in panels:
                panel.draw(size)

        self._window.callOnFlip(self._mark, f"{label} screen {screen}", 0.0)
        end = last_refresh(dues[-1].frame + 1, look.fps, rate, look.pace)
        try:
            flips = play(dues, end, self._flips, draw, again)
        finally:
            if self._patch:
                self._patch.off()
        zero, zero_wall = self._flips.zero, self._flips.zero_wall
        assert zero is not None
        assert zero_wall is not None
        if self._flip_log is not None:
            log_flips(self._flip_log, label, screen, flips, rate, zero_wall - zero)
        fresh = [flip.at for flip in flips if flip.due is not None]
        return flips[0].at - zero, tuple(frames_late(dues, fresh, rate))

    def _panels_for(self, count: int, shape: tuple[int, ...]) -> list[Panel]:
        look, picture = self._look, (shape[1], shape[0])
        placing = side_by_side(self._size(), picture, count, look.clip_height, look.enlarge)
        for n, centre in enumerate(placing.centres):
            if (count, n, shape) not in self._panels:
                self._panels[count, n, shape] = Panel(centre, placing.size)
        return [self._panels[count, n, shape] for n in range(count)]

    def _text(self, text: str, low: float | None = None) -> None:
        self._writer.draw(text, low=low)
        self._flip()

    def _flip(self) -> float:
        return self._flips.flip()

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
