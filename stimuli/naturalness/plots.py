"""A motion's errors over time, drawn without a display."""

from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from stimuli.files import write_atomic
from stimuli.naturalness.score import Naturalness
from stimuli.transition.plants import spans
from stimuli.transition.weights import SIDES

_COLOURS = ("#c1440e", "#1f5fa8")
_FLIGHT = "0.9"


def draw_course(found: Naturalness, fps: float, title: str, path: Path) -> None:
    """Slides, the distance of the zero moment point and angular momentum, one above the other."""
    from matplotlib.figure import Figure

    course = found.course
    figure = Figure(figsize=(8.0, 6.4), layout="constrained")
    slide, beyond, momentum = figure.subplots(3, 1, sharex=True)
    seconds = np.arange(found.frames) / fps
    for place, side in enumerate(SIDES):
        slide.plot(seconds, 100 * course.slide[:, place], color=_COLOURS[place], label=side)
    slide.set_ylabel("foot off its plant (cm)")
    slide.legend(fontsize="small", ncols=2, loc="upper right")
    beyond.plot(seconds, 100 * course.beyond, color="black")
    beyond.set_ylabel("zero moment point\nbeyond support (cm)")
    momentum.plot(seconds, np.linalg.norm(course.momentum, axis=1), color="black")
    momentum.set_ylabel("angular momentum\nby mass (m²/s)")
    momentum.set_xlabel("seconds")
    for axes in (slide, beyond, momentum):
        _shade(axes, course.flight, fps)
        axes.set_ylim(bottom=0)
        axes.set_xlim(0, max(seconds[-1], 1 / fps))
    slide.set_title(title)
    told = "grey: no foot bears the body" if course.flight.any() else "a foot bears it throughout"
    momentum.text(0.99, 0.95, told, transform=momentum.transAxes, ha="right", va="top", fontsize=8)
    buffer = BytesIO()
    figure.savefig(buffer, format=path.suffix[1:].lower(), dpi=110)
    write_atomic(path, buffer.getvalue())


def _shade(axes: Any, flight: np.ndarray, fps: float) -> None:
    for first, last in spans(flight):
        axes.axvspan((first - 0.5) / fps, (last + 0.5) / fps, color=_FLIGHT, lw=0, zorder=0)
