"""A scale of points on the screen: drawn below its question, answered by a key or a click."""

from dataclasses import dataclass
from typing import Any

from study.screen.texts import FILLED_HEIGHT, TEXT_COLOUR, Writer
from study.trials.prompt import RatingScale

RADIUS, SPAN, BELOW = 0.022, 0.5, 0.18  # shares of the window's height, width and height
KEYS = 1.3  # of a letter's height, the room of the keys over the points
LABELS = 0.46  # of the window's width, the room of the words at an end


@dataclass(frozen=True)
class Row:
    """Where the points of a scale lie in a window of a size in pixels, its centre the origin."""

    points: tuple[str, ...]
    size: tuple[int, int]
    letter: float

    @property
    def top(self) -> float:
        """Below which it lies with its keys, pixels from the window's centre."""
        return self.places[0][1] + self.radius + KEYS * self.letter

    @property
    def radius(self) -> float:
        """Of a point, pixels."""
        return RADIUS * self.size[1]

    @property
    def places(self) -> list[tuple[float, float]]:
        """The centres of the points, from the left."""
        width, height = self.size
        span, last = SPAN * width, max(len(self.points) - 1, 1)
        return [(span * (n / last - 0.5), -BELOW * height) for n in range(len(self.points))]

    def at(self, x: float, y: float) -> str | None:
        """The point at a place, or as near as half the way to the next."""
        reach = SPAN * self.size[0] / max(len(self.points) - 1, 1) / 2
        for point, (left, up) in zip(self.points, self.places, strict=True):
            if abs(x - left) <= reach and abs(y - up) <= 3 * self.radius:
                return point
        return None


def draw_scale(window: Any, writer: Writer, scale: RatingScale, keys: tuple[str, ...]) -> Row:
    """Draw a scale into the window's back buffer, each point with its key; where its points lie."""
    from psychopy import visual

    row = Row(scale.points, (writer.wide, writer.tall), writer.height)
    visual.Line(
        window,
        start=row.places[0],
        end=row.places[-1],
        lineColor=TEXT_COLOUR,
        lineWidth=2,
        units="pix",
    ).draw()
    apart = row.places[-1][0] - row.places[0][0]
    for place, key in zip(row.places, keys, strict=True):
        visual.Circle(
            window,
            radius=row.radius,
            pos=place,
            fillColor=TEXT_COLOUR,
            lineColor=TEXT_COLOUR,
            units="pix",
        ).draw()
        writer.draw(key, place[1] + row.radius, row.top, place[0], apart / len(keys))
    low, high = -FILLED_HEIGHT * writer.tall / 2, row.places[0][1] - 2 * row.radius
    for (x, _), label in ((row.places[0], scale.low), (row.places[-1], scale.high)):
        writer.draw(label, low, high, x, LABELS * writer.wide)
    return row


class Clicks:
    """Clicks into a window since it was asked for them, each with the seconds since then."""

    def __init__(self, window: Any) -> None:
        self._window = window
        self._found: list[tuple[float, float]] = []

    def __enter__(self) -> "Clicks":
        self._window.mouseVisible = True
        self._window.winHandle.push_handlers(on_mouse_press=self._pressed)
        return self

    def __exit__(self, *failure: object) -> None:
        self._window.winHandle.remove_handlers(on_mouse_press=self._pressed)
        self._window.mouseVisible = False

    def _pressed(self, x: float, y: float, button: int, modifiers: int) -> None:
        self._found.append((x, y))

    def taken(self) -> list[tuple[float, float]]:
        """Places of clicks since the last call, pixels from the window's centre, y up."""
        width, height = (float(v) for v in self._window.size)
        found, self._found = self._found, []
        return [(x - width / 2, y - height / 2) for x, y in found]
