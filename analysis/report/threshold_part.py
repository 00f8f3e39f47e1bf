"""The results of an odd-pair study: thresholds on both sides of the reference."""

from dataclasses import asdict
from typing import Any

import numpy as np
import pandas as pd

from analysis.psychometric import Threshold
from analysis.report.context import Context
from analysis.report.draw import GRID_COLOUR, INK, PALE, SIDE_COLOURS, canvas, quiet_y, shorten
from analysis.report.parts import Figure, Findings, ReportTable, Section
from analysis.report.supplement_part import (
    answer_bias_section,
    beside_section,
    difference_section,
    shown_section,
)
from analysis.report.track_part import track_section
from analysis.report.words import (
    beyond,
    count,
    p_value,
    rounded,
    share,
    signed,
)
from analysis.supplements import against_shown, differences, supplement
from analysis.thresholds import ALL, Entry, entries, fit_plan_of, prepared, signed_threshold

# Told as report.json tells them: nothing of a fit whose first threshold the verdict denies.
OF_THE_FIT = ("slope", "lapse", "deviance", "deviance_p")
_OF_TRACKS = {"stop_level": "Most visited", "reversal_mean": "Reversals"}
SIDE_WORDS = {"shorter": "shorter blends", "longer": "longer blends"}


def report_odd_pair(context: Context) -> Findings:
    """Psychometric fits pooled, by motion and by person, and what stands beside them."""
    specification = str(context.table("stimuli").get("specification", ""))
    trials = prepared(context.screened.main, specification)
    plan = fit_plan_of(context.protocol, context.seed)
    found = entries(trials, plan)
    beside = {
        id(entry): supplement(entry, trials, plan, context.second_opinion)
        for entry in found
        if entry.participant == ALL
    }
    tests, shown = (
        differences(trials, plan.what),
        against_shown(trials, context.study.stimuli, plan),
    )
    sections = [
        _pooled_section(context, name, [entry for entry in found if entry.specification == name])
        for name in sorted({entry.specification for entry in found})
    ]
    sections.append(beside_section(context, list(beside.values())))
    sections += [difference_section(context, tests)] if tests else []
    sections += [shown_section(context, shown)] if shown else []
    people = [entry for entry in found if entry.participant != ALL]
    sections += [_people_section(context, people)] if people else []
    sections += [track_section(context, trials)] if _has_tracks(context) else []
    sections.append(answer_bias_section(trials))
    document = {
        "psychometric": [
            entry.as_dict() | (beside[id(entry)].as_dict() if id(entry) in beside else {})
            for entry in found
        ],
        "differences": [test.as_dict() for test in tests],
        "against_shown": [asdict(fit) for fit in shown],
    }
    return Findings(tuple(sections), document)


def _has_tracks(context: Context) -> bool:
    """Whether staircases chose the levels; constant stimuli have no turns and no end."""
    return not context.protocol or "staircase" in context.protocol


def threshold_sentence(entry: Entry, number_of: int = 0) -> str:
    """One threshold in APA style, or why there is none."""
    threshold, verdict = signed_threshold(entry, number_of), entry.summary.verdicts[number_of]
    where = "" if entry.motion == ALL else f" of {entry.motion}"
    who = (
        f"{count(len(entry.data.people), 'person', 'people')}, "
        f"{count(entry.summary.trials, 'trial')}"
    )
    words = f"For {SIDE_WORDS[entry.side]}{where} ({who})"
    if verdict != "ok":
        return f"{words} the data carry no {share(threshold.at)} threshold: {verdict}."
    fit = entry.summary
    return (
        f"{words} the two pairs were told apart at a proportion of {share(threshold.at)} when the "
        f"blend differed by {signed(threshold.value)} frames, "
        f"95% CI [{', '.join(ends_in_words(threshold))}] ({fit.interval_method}); "
        f"{fit.function} function, slope {rounded(fit.slope)}, lapse rate {share(fit.lapse, 3)}"
        f"{' (at its bound)' if fit.note else ''}, "
        f"deviance {rounded(fit.deviance)}, simulated {p_value(fit.deviance_p)}."
    )


def ends_in_words(threshold: Threshold) -> tuple[str, str]:
    """Both ends of a signed threshold: numbers within the levels shown, else “beyond −8”."""
    low, high = threshold.beyond_low, threshold.beyond_high
    return (
        signed(threshold.low) if low is None else beyond(low),
        signed(threshold.high) if high is None else beyond(high),
    )


def _pooled_section(context: Context, specification: str, found: list[Entry]) -> Section:
    pooled = [e for e in found if e.participant == ALL]
    whole = [e for e in pooled if e.motion == ALL]
    stem = f"{context.stem}-{specification or 'thresholds'}"
    return Section(
        f"Thresholds of {specification} transitions" if specification else "Thresholds",
        findings=tuple(threshold_sentence(entry) for entry in whole),
        figures=(_curves(stem, whole),),
        tables=(_table(f"{stem}-thresholds", pooled, _has_tracks(context)),),
    )


def _table(name: str, found: list[Entry], tracks: bool) -> ReportTable:
    rows = [
        {
            "side": entry.side,
            "specification": entry.specification,
            "motion": entry.motion,
            "participant": entry.participant,
            "people": len(entry.data.people),
            "n": entry.summary.trials,
            "at": threshold.at,
            "value": value.value,
            "low": value.low if value.beyond_low is None else float("nan"),
            "high": value.high if value.beyond_high is None else float("nan"),
            "ends": " to ".join(ends_in_words(value)) if verdict == "ok" else "–",
            **{name: told[name] for name in OF_THE_FIT},
            "stop_level": entry.staircase["stop_level"],
            "reversal_mean": entry.staircase["reversal_mean"],
            "verdict": verdict,
        }
        for entry in found
        for told in [entry.summary.as_dict()]
        for place, (threshold, verdict) in enumerate(
            zip(entry.summary.thresholds, entry.summary.verdicts, strict=True)
        )
        for value in [signed_threshold(entry, place)]
    ]
    data = pd.DataFrame(rows)
    numbers = ["value", "low", "high", *OF_THE_FIT]
    data[numbers] = data[numbers].astype(float)
    data.loc[data["verdict"] != "ok", ["value", "low", "high"]] = np.nan
    for column in ("value", "low", "high"):
        data.loc[~np.isfinite(data[column]), column] = np.nan
    return ReportTable(
        name,
        "Thresholds in frames of blend length beyond the reference (signed).",
        data.drop(columns="ends" if tracks else ["ends", *_OF_TRACKS]),
        _shown(data).drop(columns=[] if tracks else list(_OF_TRACKS.values())),
        (
            "“Most visited” is the level answered most often, “reversals” the mean at the track's "
            "turns; both are means over tracks. "
            if tracks
            else ""
        )
        + "A dash: not identifiable. “Beyond”: the interval reaches past the last level shown, "
        "where these answers say nothing.",
    )


def _shown(data: pd.DataFrame) -> pd.DataFrame:
    """The table in print: of single people only the leading threshold."""
    by_person = bool((data["participant"] != ALL).any())
    if by_person:
        data = data[data["at"] == data["at"].iloc[0]]
    return pd.DataFrame(
        {
            "Side": data["side"],
            ("Person" if by_person else "Motion"): data["participant" if by_person else "motion"],
            "Trials": data["n"].map(str),
            "At": data["at"].map(share),
            "Threshold": data["value"].map(signed),
            "95% interval": data["ends"],
            "Slope": data["slope"].map(rounded),
            "Deviance p": data["deviance_p"].map(lambda p: share(p, 3)),
            **{words: data[name].map(signed) for name, words in _OF_TRACKS.items()},
        }
    )


def _curves(stem: str, whole: list[Entry]) -> Figure:
    with canvas(7.2, 3.7) as drawn:
        axis = drawn.figure.subplots()
        axis.axhline(0.5, color=PALE, linewidth=1, linestyle=(0, (4, 3)))
        axis.axvline(0, color=GRID_COLOUR, linewidth=1)
        for entry in whole:
            _side(axis, entry)
        axis.set_ylim(0.28, 1.03)
        axis.set_xlabel("difference from the reference length (frames)")
        axis.set_ylabel("proportion right")
        axis.legend(loc="lower right", fontsize=8.5)
    return Figure(
        f"{stem}-curves",
        "Proportion of odd pairs found, by signed difference in blend length. Each dot is a "
        "level, its area the number of trials; curves are maximum-likelihood fits to each side; "
        "bars are 95% intervals of the threshold. The dashed line is chance.",
        drawn.svg,
    )


def _side(axis: Any, entry: Entry) -> None:
    data, colour = entry.counts, SIDE_COLOURS[entry.side]
    x = entry.sign * data.levels
    size = 12 + 160 * data.total / data.total.max()
    axis.scatter(x, data.correct / data.total, s=size, color=colour, alpha=0.35, linewidth=0)
    label = f"{entry.side} (n = {data.trials})"
    if entry.summary.verdict != "ok":
        axis.plot([], [], color=colour, label=f"{label}: not identifiable")
        return
    smooth = np.linspace(data.levels[0], data.levels[-1], 200)
    axis.plot(entry.sign * smooth, entry.summary.proportion(smooth), color=colour, label=label)
    threshold = signed_threshold(entry)
    _interval(axis, threshold, colour)


def _interval(axis: Any, threshold: Threshold, colour: str) -> None:
    y = threshold.at
    low = np.clip(threshold.low, threshold.least, threshold.most)
    high = np.clip(threshold.high, threshold.least, threshold.most)
    axis.plot([low, high], [y, y], color=INK, linewidth=1.2, solid_capstyle="butt", zorder=4)
    axis.plot([threshold.value], [y], "o", color=colour, mec=INK, ms=5, zorder=5)


def _people_section(context: Context, people: list[Entry]) -> Section:
    known = [entry for entry in people if entry.summary.verdict == "ok"]
    refused = len(people) - len(known)
    tracks = _has_tracks(context)
    why = "short tracks" if tracks else "answers to few levels"
    text = (
        f"{count(len(known), 'fit')} of single people are identifiable and "
        f"{refused} {'is' if refused == 1 else 'are'} not: {why} seldom carry a person's "
        "own function, and the pooled fits above do not need it.",
    )
    if not known:
        return Section("Person by person", text=text)
    table = _table(f"{context.stem}-people", people, tracks)
    figure = _people_figure(context.stem, known)
    return Section("Person by person", text=text, figures=(figure,), tables=(table,))


def _people_figure(stem: str, known: list[Entry]) -> Figure:
    names = sorted({entry.participant for entry in known})
    with canvas(7.2, 0.9 + 0.2 * len(names)) as drawn:
        axis = drawn.figure.subplots()
        axis.axvline(0, color=GRID_COLOUR, linewidth=1)
        edge = max(float(entry.counts.levels[-1]) for entry in known) * 1.15
        for entry in known:
            threshold = signed_threshold(entry)
            place = names.index(entry.participant)
            shown = (threshold.least, threshold.most)
            ends = np.clip([threshold.low, threshold.high], *shown)
            axis.plot(ends, [place, place], color=SIDE_COLOURS[entry.side], linewidth=1, alpha=0.6)
            axis.plot([threshold.value], [place], "o", color=SIDE_COLOURS[entry.side], ms=4.5)
        axis.set_yticks(range(len(names)), shorten(names))
        axis.set_ylim(len(names) - 0.4, -0.6)
        axis.set_xlim(-edge, edge)
        axis.set_xlabel("threshold (frames of difference)")
        quiet_y(axis)
    return Figure(
        f"{stem}-people",
        "Thresholds of single people with 95% profile-likelihood intervals, cut at the edge "
        "of the levels; people whose data carry none are left out.",
        drawn.svg,
    )
