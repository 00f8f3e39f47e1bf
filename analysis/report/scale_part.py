"""The Bradley-Terry scale of a study with three methods or more."""

from dataclasses import asdict

import pandas as pd

from analysis.bradley_terry import Strength
from analysis.report.context import Context
from analysis.report.draw import INK, LONGER, PALE, canvas, quiet_y, shorten
from analysis.report.parts import Figure, ReportTable, Section
from analysis.report.words import interval, rounded

TITLE = "A scale of the methods"


def scale_section(context: Context, strengths: list[Strength] | None) -> Section:
    """The methods on one scale, or why there is none."""
    if strengths is None:
        why = (
            "No scale of the methods can be estimated: some method was always, or never, preferred "
            "to the rest, so that its distance has no bound."
        )
        return Section(TITLE, text=(why,))
    best, last = strengths[0], strengths[-1]
    told = (
        f"On the Bradley-Terry scale (log odds, mean 0) {best.method} stands highest at "
        f"{rounded(best.strength)}, {interval(best.low, best.high)}, and {last.method} lowest at "
        f"{rounded(last.strength)}, {interval(last.low, last.high)} (people resampled)."
    )
    data = pd.DataFrame([asdict(entry) for entry in strengths])
    shown = pd.DataFrame(
        {
            "Method": data["method"],
            "Strength": data["strength"].map(rounded),
            "95% interval": [f"{rounded(s.low)} to {rounded(s.high)}" for s in strengths],
        }
    )
    stem = f"{context.stem}-scale"
    note = "The odds that one method is preferred to another are e to the difference of strengths."
    return Section(
        TITLE,
        findings=(told,),
        figures=(_figure(stem, strengths),),
        tables=(ReportTable(stem, "Bradley-Terry strengths.", data, shown, note),),
    )


def _figure(stem: str, strengths: list[Strength]) -> Figure:
    with canvas(7.2, 0.8 + 0.32 * len(strengths)) as drawn:
        axis = drawn.figure.subplots()
        axis.axvline(0, color=PALE, linewidth=1, linestyle=(0, (4, 3)))
        for place, entry in enumerate(strengths):
            if entry.low is not None and entry.high is not None:
                axis.plot([entry.low, entry.high], [place, place], color=LONGER)
            axis.plot([entry.strength], [place], "o", color=INK, ms=6)
        axis.set_yticks(range(len(strengths)), shorten([entry.method for entry in strengths]))
        axis.set_ylim(len(strengths) - 0.4, -0.6)
        axis.set_xlabel("strength (log odds)")
        quiet_y(axis)
    return Figure(stem, "Strengths with 95% intervals, people resampled.", drawn.svg)
