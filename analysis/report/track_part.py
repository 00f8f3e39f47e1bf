"""The staircases as they ran."""

from typing import Any

import numpy as np
import pandas as pd

from analysis.report.context import Context
from analysis.report.draw import GRID_COLOUR, SIDE_COLOURS, canvas
from analysis.report.parts import Figure, Section
from analysis.report.words import count
from analysis.tracks import AnsweredTrack, tracks

_SHOWN = 24  # people whose tracks are drawn; the tables hold them all


def track_section(context: Context, trials: pd.DataFrame) -> Section:
    """Every track of the first people, signed, with right and wrong answers."""
    found = tracks(trials)
    people = sorted({track.participant for track in found})
    edges = _at_the_edge(context)
    text = [
        f"{count(len(found), 'track')}, one for each person, motion and side. "
        "A filled dot is a right answer, an open one a wrong answer."
    ]
    if edges:
        text.append(
            f"{count(edges, 'track')} ended at the first or last level there is: "
            "such a track says only that the threshold lies near or beyond that level."
        )
    if len(people) > _SHOWN:
        text.append(f"The figure shows the first {_SHOWN} people of {len(people)}.")
    return Section("Staircases", text=tuple(text), figures=(_figure(context, found, people),))


def _at_the_edge(context: Context) -> int:
    """Tracks that the sidecars mark as ended at an edge."""
    held = [session.sidecar.get("Tracks") for session in context.study.sessions]
    return sum(
        bool(track.get("ended_at_edge"))
        for entry in held
        if isinstance(entry, dict)
        for track in entry.values()
        if isinstance(track, dict)
    )


def _figure(context: Context, found: list[AnsweredTrack], people: list[str]) -> Figure:
    shown = people[:_SHOWN]
    columns = min(3, len(shown))
    rows = -(-len(shown) // columns)
    reach = max(float(track.levels.max()) for track in found) * 1.12
    height = 0.6 + 1.25 * rows
    with canvas(7.4, height, constrained=False) as drawn:
        axes = drawn.figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
        drawn.figure.subplots_adjust(
            left=0.09, right=0.99, bottom=0.42 / height, top=1 - 0.25 / height, hspace=0.3,
            wspace=0.08,
        )  # fmt: skip
        for axis in axes.flat[len(shown) :]:
            axis.set_visible(False)
        for axis, person in zip(axes.flat, shown, strict=False):
            axis.axhline(0, color=GRID_COLOUR, linewidth=1)
            for side in SIDE_COLOURS:
                _draw(axis, [t for t in found if (t.participant, t.side) == (person, side)], side)
            axis.set_title(person, fontsize=8, pad=2)
            axis.set_ylim(-reach, reach)
            axis.tick_params(labelsize=7.5)
        drawn.figure.supxlabel("trial of the track", fontsize=9, y=0.08 / height)
        drawn.figure.supylabel("difference (frames)", fontsize=9, x=0.01)
    return Figure(
        f"{context.stem}-tracks",
        "Staircase tracks: the signed difference shown at each trial of a track.",
        drawn.svg,
    )


def _draw(axis: Any, own: list[AnsweredTrack], side: str) -> None:
    """All tracks of one person and side: joined by gaps, so that few artists are drawn."""
    if not own:
        return
    gap = np.array([np.nan])
    x = np.concatenate([np.append(np.arange(1.0, len(t.differences) + 1), gap) for t in own])
    y = np.concatenate([np.append(t.differences, gap) for t in own])
    right = np.concatenate([np.append(t.correct, gap) for t in own])
    colour = SIDE_COLOURS[side]
    axis.plot(x, y, color=colour, linewidth=0.8, alpha=0.7)
    for answer, face in ((1.0, colour), (0.0, "white")):
        kept = right == answer
        axis.plot(x[kept], y[kept], "o", ms=2.4, mew=0.6, mec=colour, mfc=face)
