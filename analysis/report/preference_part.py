"""The results of a preference study."""

from dataclasses import asdict
from typing import Any

import pandas as pd

from analysis.preferences import ALL, Contest, Preference, contests
from analysis.report.context import Context
from analysis.report.draw import GRID, INK, LONGER, PALE, canvas, quiet_y, shorten
from analysis.report.parts import Figure, Findings, Section, Table
from analysis.report.words import interval, number, p_value, sentence_case, share


def report_preference(context: Context) -> Findings:
    """χ², exact test and interval for every pair of methods, by category and by motion."""
    methods = tuple(str(m) for m in context.protocol.get("methods") or ())
    found = contests(context.screened.main, methods)
    sections = tuple(_section(context, contest) for contest in found)
    return Findings(sections, {"comparisons": [comparison(contest) for contest in found]})


def comparison(contest: Contest) -> dict[str, Any]:
    """The comparison of report.json."""
    return {
        "a": contest.a,
        "b": contest.b,
        "category": contest.category,
        **asdict(contest.count),
        "per_motion": [
            {"motion": motion, **asdict(count)} for motion, count in contest.per_motion()
        ],
    }


def sentence(contest: Contest, alpha: float) -> str:
    """The pooled result in APA style."""
    count = contest.count
    if count.n == 0:
        return f"Nobody answered a comparison of {contest.a} and {contest.b}."
    where = "" if contest.category == ALL else f" for {contest.category} motions"
    significant = count.p is not None and count.p < alpha
    return (
        f"{sentence_case(contest.a)} was preferred to {contest.b}{where} in {count.prefer_a} of "
        f"{count.n} answers ({number(count.percent, 1)}%, "
        f"{interval(count.low, count.high, 1)}), χ²({count.df}, N = {count.n}) = "
        f"{number(count.chi2)}, {p_value(count.p)} (exact binomial test, "
        f"{p_value(count.binomial_p)}); the preference is "
        f"{'significant' if significant else 'not significant'} at α = {share(alpha)}."
    )


def _title(contest: Contest) -> str:
    title = f"{sentence_case(contest.a)} against {contest.b}"
    return title if contest.category == ALL else f"{title}: {contest.category}"


def _section(context: Context, contest: Contest) -> Section:
    stem = f"{context.stem}-{contest.a}-{contest.b}-{contest.category}"
    rows = [("all motions", contest.count), *contest.per_motion()]
    return Section(
        _title(contest),
        findings=(sentence(contest, context.alpha),),
        figures=(_figure(stem, contest, rows),),
        tables=(_table(stem, contest, rows),),
    )


def _table(stem: str, contest: Contest, rows: list[tuple[str, Preference]]) -> Table:
    data = pd.DataFrame([{"motion": motion, **asdict(count)} for motion, count in rows])
    shown = pd.DataFrame(
        {
            "Motion": [motion for motion, _ in rows],
            "n": [str(count.n) for _, count in rows],
            f"Chose {contest.a}": [str(count.prefer_a) for _, count in rows],
            "%": [number(count.percent, 1) for _, count in rows],
            "95% interval": [
                f"{number(count.low, 1)} to {number(count.high, 1)}" for _, count in rows
            ],
            "χ²(1)": [number(count.chi2) for _, count in rows],
            "p": [p_value(count.p).removeprefix("p ").removeprefix("= ") for _, count in rows],
            "exact p": [
                p_value(count.binomial_p).removeprefix("p ").removeprefix("= ") for _, count in rows
            ],
        }
    )
    return Table(
        stem,
        f"Answers that chose {contest.a} over {contest.b}.",
        data,
        shown,
        "χ² against one half; the interval is Wilson's.",
    )


def _figure(stem: str, contest: Contest, rows: list[tuple[str, Preference]]) -> Figure:
    kept = [(motion, count) for motion, count in rows if count.percent is not None]
    with canvas(7.2, 0.8 + 0.3 * len(kept)) as drawn:
        axis = drawn.figure.subplots()
        axis.axvline(50, color=PALE, linewidth=1, linestyle=(0, (4, 3)))
        for place, (_, count) in enumerate(kept):
            colour = INK if place == 0 else LONGER
            axis.axhline(place, color=GRID, linewidth=0.7, zorder=0)
            axis.plot([count.low, count.high], [place, place], color=colour, solid_capstyle="butt")
            axis.plot([count.percent], [place], "D" if place == 0 else "o", color=colour, ms=6)
        axis.set_yticks(range(len(kept)), shorten([motion for motion, _ in kept]))
        axis.set_ylim(len(kept) - 0.4, -0.6)
        axis.set_xlim(-1, 101)
        axis.set_xlabel(f"% that chose {contest.a} over {contest.b}")
        quiet_y(axis)
    return Figure(
        stem,
        f"Share of answers that chose {contest.a}, with 95% Wilson intervals; "
        "the dashed line is chance.",
        drawn.svg,
    )
