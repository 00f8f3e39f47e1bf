"""A square in a corner of the window that turns with every clip frame, for a photodiode on it.

It is white while the first frame of a clip is shown, black with the second, and so on, and black
wherever no clip is: the first frame's onset is an edge, and so is each change of frame.
"""

from typing import Any

import numpy as np

from study.screen.panel import Panel

SQUARE = 0.06  # of the window's height
WHITE_BLACK = (255, 0)


class Patch:
    """The square in a corner (`bottom-left`, …) of a window of a size in pixels."""

    def __init__(self, corner: str, window: tuple[int, int]) -> None:
        self._window = window
        self.corner, self.side = corner, max(round(SQUARE * window[1]), 8)
        up = 1 if corner.startswith("top") else -1
        right = 1 if corner.endswith("right") else -1
        centre = tuple(
            sign * (length - self.side) / 2
            for sign, length in zip((right, up), window, strict=True)
        )
        self._panel = Panel((centre[0], centre[1]), (self.side, self.side))
        self.off()

    def frame(self, place: int) -> None:
        """From the next flip on the frame with this place in its clip is shown."""
        self._panel.fill(np.full((1, 1, 3), WHITE_BLACK[place % 2], np.uint8))

    def off(self) -> None:
        """From the next flip on no clip is shown."""
        self._panel.fill(np.full((1, 1, 3), WHITE_BLACK[1], np.uint8))

    def draw(self) -> None:
        """Draw it over what is in the back buffer."""
        self._panel.draw(self._window)

    def facts(self) -> dict[str, Any]:
        """For the record: its corner, and its side in pixels."""
        return {"corner": self.corner, "side": self.side}

    def delete(self) -> None:
        """Give the texture back."""
        self._panel.delete()
