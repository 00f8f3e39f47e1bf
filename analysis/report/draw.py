"""The figures' common look, and SVG out of them.

Figures are drawn without pyplot, so that nothing is kept between them; text stays text, and
dollar signs in names from logs are no formulas.
"""

import io
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

INK, PALE, GRID_COLOUR = "#1f2933", "#8795a1", "#e4e7eb"
SHORTER, LONGER = "#b7410e", "#1d5b99"
SIDE_COLOURS = {"shorter": SHORTER, "longer": LONGER}
SERIES = ("#1d5b99", "#b7410e", "#3b7a57", "#7b4f9d", "#a3791c", "#52606d")

_STYLE: Any = {
    "svg.fonttype": "none",
    "svg.hashsalt": "segue",
    "text.parse_math": False,
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 9.5,
    "axes.edgecolor": PALE,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 10,
    "axes.titlelocation": "left",
    "xtick.color": INK,
    "ytick.color": INK,
    "text.color": INK,
    "axes.grid": False,
    "legend.frameon": False,
    "lines.linewidth": 1.6,
    "figure.constrained_layout.use": True,
}


class Canvas:
    """A figure being drawn; `svg` holds the result after the `canvas` block."""

    def __init__(self, figure: Any) -> None:
        self.figure = figure
        self.svg = ""


@contextmanager
def canvas(width: float = 7.2, height: float = 3.6, constrained: bool = True) -> Iterator[Canvas]:
    """A figure of `width` × `height` inches in the common style, turned to SVG at the end.

    Many panels lay themselves out faster when not `constrained`.
    """
    import matplotlib
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    style = _STYLE | {"figure.constrained_layout.use": constrained}
    with matplotlib.rc_context(style):
        held = Canvas(Figure(figsize=(width, height)))
        FigureCanvasSVG(held.figure)
        yield held
        buffer = io.StringIO()
        held.figure.savefig(buffer, format="svg", metadata={"Date": None}, transparent=True)
    held.svg = _inline(buffer.getvalue())


def _inline(text: str) -> str:
    """The `<svg>` element alone, scalable, ready to stand in a page or in a file."""
    body = text[text.index("<svg ") :]
    body = re.sub(r"<metadata>.*?</metadata>", "", body, flags=re.DOTALL)
    return body.strip() + "\n"


def plain_ticks(axis: Any, places: Iterable[int]) -> None:
    """Whole numbers as marks: those of a logarithmic scale are TeX, which stays text here."""
    places = list(places)
    axis.set_ticks(places, [str(place) for place in places])
    axis.set_ticks([], minor=True)


def quiet_y(axis: Any) -> None:
    """Names on the y axis without marks."""
    axis.spines["left"].set_visible(False)
    axis.tick_params(axis="y", length=0)


def shorten(names: Sequence[str], most: int = 28) -> list[str]:
    """Names short enough for an axis."""
    return [name if len(name) <= most else name[: most - 1] + "…" for name in names]
