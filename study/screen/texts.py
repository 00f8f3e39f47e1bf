"""Texts on a screen: large enough to read from a metre, and never beyond the edge of the window."""

import re
from typing import Any

import numpy as np

from study.screen.placing import pixel_side

TEXT_COLOUR = (-0.85, -0.85, -0.85)
DEGREES, DISTANCE = 0.7, 100.0  # what a capital is seen under, and from how far (cm)
CAPITAL = 0.72  # of the height that a letter is drawn in
LEAST_SHARE = 1 / 24  # of a window's height: the least that a letter is drawn in
FILLED_WIDTH, FILLED_HEIGHT = 0.9, 0.92  # the part of a window that texts may fill
SMALLER = 0.94  # from one size of letters to the next that is tried


def letter_height(window: tuple[int, int], pixel: float) -> float:
    """The height (pixels) in which letters are drawn, for capitals of DEGREES at DISTANCE.

    `pixel` is the side of one (cm). A screen whose system tells a width that it has not, as X
    servers do, has letters of a share of its height at least.
    """
    seen = 2 * DISTANCE * np.tan(np.radians(DEGREES) / 2) / pixel
    return float(max(seen / CAPITAL, LEAST_SHARE * window[1]))


class Writer:
    """Draws texts into the back buffer of a PsychoPy window; lengths are in pixels, y is up."""

    def __init__(self, window: Any, screen_width: float | None) -> None:
        self._window = window
        self.wide, self.tall = (int(v) for v in window.size)
        pixel = pixel_side(window.winHandle.screen, screen_width)
        self.height = letter_height((self.wide, self.tall), pixel)

    def draw(
        self, text: str, low: float | None = None, high: float | None = None,
        at: float = 0.0, wide: float | None = None,
    ) -> float:  # fmt: skip
        """Draw a text between two heights (by default the window's) around the middle `at`.

        Letters are smaller only where the text would not fit otherwise; their height.
        """
        edge = FILLED_HEIGHT * self.tall / 2
        low, high = -edge if low is None else low, edge if high is None else high
        across = FILLED_WIDTH * self.wide if wide is None else wide
        height = self.height
        if not text.strip():
            return height
        stimulus = self._laid(text, height, across)
        while not _fits(stimulus, across, high - low) and height > 8:
            height *= SMALLER
            stimulus = self._laid(text, height, across)
        stimulus.pos = (at, (low + high) / 2)
        stimulus.draw()
        return height

    def pages(self, text: str) -> list[str]:
        """A text in as many parts as it takes to show it in letters that are large enough.

        It is parted between paragraphs; between the words of one that is too long, or that would
        leave more than half of a page empty.
        """
        across, room = FILLED_WIDTH * self.wide, FILLED_HEIGHT * self.tall

        def fits(part: str, share: float = 1.0) -> bool:
            return _fits(self._laid(part, self.height, across), across, share * room)

        if not text.strip() or fits(text):
            return [text]
        below = 1 - self.foot / room
        pages = [""]
        for block in text.split("\n\n"):
            whole = f"{pages[-1]}\n\n{block}".lstrip("\n")
            if fits(whole, below):
                pages[-1] = whole
                continue
            if pages[-1] and not fits(pages[-1], below / 2):
                pages.append("")
            lead = "\n\n" if pages[-1] else ""
            for word in re.findall(r"\S+\s*", block):
                longer = f"{pages[-1]}{lead}{word}"
                if not pages[-1] or fits(longer.rstrip(), below):
                    pages[-1] = longer
                else:
                    pages.append(word)
                lead = ""
            pages[-1] = pages[-1].rstrip()
        return [page.rstrip() for page in pages]

    @property
    def foot(self) -> float:
        """How much of the height the line takes that says that a text goes on."""
        return 1.4 * self.height

    def draw_page(self, text: str, number: int, count: int, key: str) -> None:
        """Draw one part of a text, with the key that shows the next below it."""
        if number == count:
            self.draw(text)
            return
        edge = FILLED_HEIGHT * self.tall / 2
        self.draw(text, low=-edge + self.foot)
        self.draw(f"{key} ›   {number}/{count}", low=-edge, high=-edge + self.foot)

    def _laid(self, text: str, height: float, across: float) -> Any:
        from psychopy import visual

        return visual.TextStim(
            self._window, text=text, height=height, wrapWidth=across, color=TEXT_COLOUR,
            units="pix", alignText="center",
        )  # fmt: skip


def _fits(stimulus: Any, across: float, room: float) -> bool:
    wide, tall = stimulus.boundingBox
    return bool(wide <= across + 1 and tall <= room)
