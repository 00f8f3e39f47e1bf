"""The results of a study of naturalness labels."""

from dataclasses import asdict

import numpy as np
import pandas as pd

from analysis.naturalness import (
    AreaDifference,
    ReceiverCurve,
    agreement,
    called_unnatural,
    delong,
    labels,
    receiver_curve,
    scores_of,
)
from analysis.psychometric.functions import Array
from analysis.report.context import Context
from analysis.report.draw import GRID_COLOUR, PALE, SERIES, canvas
from analysis.report.parts import Figure, Findings, ReportTable, Section
from analysis.report.words import count, interval, p_value, rounded, share

OURS = "naturalness"  # the score that others are held against, where clips have it
DRAWN = 6  # curves in the figure; the table has them all


def report_natural(context: Context) -> Findings:
    """Agreement of people, and the receiver operating curve of every score in the manifest."""
    rng = np.random.default_rng(context.seed)
    found = labels(context.screened.main)
    alike = agreement(found)
    scores = scores_of(found.clips, context.study.stimuli)
    curves = [
        curve
        for name, values in scores.items()
        if (curve := receiver_curve(name, values, found, rng)) is not None
    ]
    tests = _differences(curves, scores, called_unnatural(found))
    unnatural = float(found.unnatural.sum() / (found.unnatural + found.natural).sum())
    answers = int((found.unnatural + found.natural).sum())
    alpha = alike["krippendorff_alpha"]
    first = (
        f"{count(len(found.people), 'person', 'people')} gave {count(answers, 'answer')} on "
        f"{count(len(found.clips), 'clip')}; "
        f"{rounded(100 * unnatural, 1)}% were “unnatural”. Agreement between people: "
        f"Krippendorff's α = {share(alpha) if alpha is not None else 'not defined'}; two people "
        f"gave a clip the same answer in {rounded(100 * (alike['pairwise'] or 0), 1)}% of pairs."
    )
    document = {
        "agreement": alike,
        "receiver_curves": [
            {"score": c.score, "area": c.area, "low": c.low, "high": c.high, "n": c.answers}
            for c in curves
        ],
        "area_differences": [asdict(test) for test in tests],
    }
    section = Section(
        "Naturalness",
        text=() if curves else ("The records hold no scores of these clips to hold against them.",),
        findings=(first, *map(_sentence, curves), *map(_difference_sentence, tests)),
        figures=(_figure(context.stem, curves),) if curves else (),
        tables=(_table(context.stem, curves),) if curves else (),
    )
    return Findings((section,), document)


def _sentence(curve: ReceiverCurve) -> str:
    told = curve.low > 0.5 or curve.high < 0.5
    return (
        f"The score {curve.score} {'tells' if told else 'does not tell'} natural from unnatural "
        f"clips: area under the receiver operating curve {share(curve.area)}, "
        f"{interval(curve.low, curve.high)} (people and clips resampled)."
    )


def _differences(
    curves: list[ReceiverCurve], scores: dict[str, Array], unnatural: Array
) -> list[AreaDifference]:
    """The score against every other: Segue's own, else the one that tells most."""
    if len(curves) < 2:
        return []
    names = [curve.score for curve in sorted(curves, key=lambda c: (-abs(c.area - 0.5), c.score))]
    held = OURS if OURS in names else names[0]
    found = [delong(scores, held, other, unnatural) for other in names if other != held]
    return [test for test in found if test is not None]


def _difference_sentence(test: AreaDifference) -> str:
    told = "differ" if test.p < 0.05 else "do not differ significantly"
    return (
        f"The areas of {test.first} and {test.second} {told}: {share(test.areas[0])} against "
        f"{share(test.areas[1])} over {count(test.clips, 'clip')} as most people called them, "
        f"difference {share(test.difference)}, "
        f"95% CI [{share(test.low)}, {share(test.high)}], "
        f"z = {rounded(test.z)}, {p_value(test.p)} (DeLong)."
    )


def _table(stem: str, curves: list[ReceiverCurve]) -> ReportTable:
    data = pd.DataFrame(
        [
            {"score": c.score, "n": c.answers, "area": c.area, "low": c.low, "high": c.high}
            for c in curves
        ]
    )
    shown = pd.DataFrame(
        {
            "Score": data["score"],
            "Answers": data["n"].map(str),
            "Area": data["area"].map(share),
            "95% interval": [f"{share(c.low)} to {share(c.high)}" for c in curves],
        }
    )
    return ReportTable(f"{stem}-scores", "Scores against the answers.", data, shown)


def _figure(stem: str, curves: list[ReceiverCurve]) -> Figure:
    best = sorted(curves, key=lambda curve: -abs(curve.area - 0.5))[:DRAWN]
    with canvas(4.6, 4.4) as drawn:
        axis = drawn.figure.subplots()
        axis.plot([0, 1], [0, 1], color=PALE, linewidth=1, linestyle=(0, (4, 3)))
        for colour, curve in zip(SERIES, best, strict=False):
            label = f"{curve.score[:32]} ({share(curve.area)})"
            axis.plot(curve.false_alarms, curve.hits, color=colour, label=label)
        axis.set_aspect("equal")
        axis.grid(color=GRID_COLOUR, linewidth=0.6)
        axis.set_xlabel("natural clips with a higher score")
        axis.set_ylabel("unnatural clips with a higher score")
        axis.legend(loc="lower right", fontsize=8)
    return Figure(
        f"{stem}-curves",
        "Receiver operating curves with their areas; the dashed line is chance.",
        drawn.svg,
    )
