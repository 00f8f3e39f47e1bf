"""The staircases as they ran."""

from typing import Any

import numpy as np
import pandas as pd

from analysis.report.context import Context
from analysis.report.draw import GRID, SIDES, canvas
from analysis.report.parts import Figure, Section
from analysis.report.words import count
from analysis.tracks import Track, tracks

SHOWN = 24  # people whose tracks are drawn; the tables hold them all


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
    if len(people) > SHOWN:
        text.append(f"The figure shows the first {SHOWN} people of {len(people)}.")
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


def _figure(context: Context, found: list[Track], people: list[str]) -> Figure:
    shown = people[:SHOWN]
    columns = min(3, len(shown))
    rows = -(-len(shown) // columns)
    reach = max(float(track.levels.max()) for track in found) * 1.12
    with canvas(7.4, 0.4 + 1.25 * rows) as drawn:
        axes = drawn.figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
        for axis in axes.flat[len(shown) :]:
            axis.set_visible(False)
        for axis, person in zip(axes.flat, shown, strict=False):
            axis.axhline(0, color=GRID, linewidth=1)
            for track in found:
                if track.participant == person:
                    _draw(axis, track)
            axis.set_title(person, fontsize=8, pad=2)
            axis.set_ylim(-reach, reach)
            axis.tick_params(labelsize=7.5)
        drawn.figure.supxlabel("trial of the track", fontsize=9)
        drawn.figure.supylabel("difference (frames)", fontsize=9)
    return Figure(
        f"{context.stem}-tracks",
        "Staircase tracks: the signed difference shown at each trial of a track.",
        drawn.svg,
    )


def _draw(axis: Any, track: Track) -> None:
    x, colour = np.arange(1, len(track.differences) + 1), SIDES[track.side]
    axis.plot(x, track.differences, color=colour, linewidth=0.8, alpha=0.7)
    for right, face in ((1.0, colour), (0.0, "white")):
        kept = track.correct == right
        axis.plot(x[kept], track.differences[kept], "o", ms=2.4, mew=0.6, mec=colour, mfc=face)
