"""The dissertation's figures, for the protocols that reproduce its studies."""

from typing import Any

import pandas as pd

from analysis.report.context import Context
from analysis.report.parts import ReportTable, Section
from analysis.report.words import p_value, rounded, signed

SOURCE = "Wang 2005"

# (a, b, category) of Table V.2: percentage for a, χ², N. Study four is one protocol of two parts.
PREFERENCES: dict[tuple[str, str, str], tuple[float, float, int]] = {
    ("geodesic", "fixed", "all"): (96.4, 241.4, 280),
    ("velocity", "fixed", "all"): (65.7, 27.7, 280),
    ("geodesic", "timewarp", "all"): (55.7, 3.66, 280),
    ("geodesic", "velocity", "locomotion"): (75.0, 9.0, 36),
    ("geodesic", "velocity", "activity"): (11.1, 21.8, 36),
}

# Thresholds in frames (VI.3.1 and VI.3.2), printed without the proportion that they stand for.
THRESHOLDS: dict[tuple[str, str], float] = {
    ("center-aligned", "shorter"): -7.0,
    ("center-aligned", "longer"): 10.0,
    ("start-end", "shorter"): -3.0,
    ("start-end", "longer"): 2.0,
}

# Of IV.4.1, by question and test: what is printed, and the printed p or mean.
RATINGS: dict[tuple[str, str], tuple[str, float]] = {
    ("realism", "signed-rank, method"): ("p", 0.01),
    ("noticeability", "signed-rank, method"): ("p", 0.34),
    ("realism", "ANOVA, ratings independent: method"): ("F", 6.39),
    ("realism", "ANOVA, ratings independent: order"): ("F", 0.87),
    ("noticeability", "ANOVA, ratings independent: method"): ("F", 1.24),
    ("looks better", "signed-rank, midpoint"): ("mean", 2.73),
    ("more natural", "signed-rank, midpoint"): ("mean", 2.69),
}

OF_THRESHOLDS = (
    "His thresholds are printed without a proportion; they stand here beside the .75 threshold. "
)

FigureRow = tuple[str, str, str]


def published_section(context: Context, document: dict[str, Any]) -> Section | None:
    """A table beside the dissertation's figures; None for a protocol that reproduces none."""
    if SOURCE not in str(context.protocol.get("source", "")):
        return None
    thresholds = _thresholds(document.get("psychometric", []))
    rows = [
        *_preferences(document.get("comparisons", [])),
        *thresholds,
        *_ratings(document.get("ratings", [])),
    ]
    if not rows:
        return None
    shown = pd.DataFrame(rows, columns=["Figure", "Dissertation", "Here"])
    data = shown.rename(columns=str.lower)
    table = ReportTable(
        f"{context.stem}-published",
        "What is printed in Wang (2005), and what these sessions give.",
        data,
        shown,
        (OF_THRESHOLDS if thresholds else "")
        + "The studies differ in people, motions and equipment.",
    )
    return Section("Beside the dissertation", tables=(table,))


def _preferences(comparisons: list[dict[str, Any]]) -> list[FigureRow]:
    rows = []
    for entry in comparisons:
        key = (entry["a"], entry["b"], entry["category"])
        turned = (entry["b"], entry["a"], entry["category"])
        if key not in PREFERENCES and turned not in PREFERENCES:
            continue
        percent, chi2, n = PREFERENCES.get(key) or PREFERENCES[turned]
        percent = percent if key in PREFERENCES else 100 - percent
        where = "" if entry["category"] == "all" else f", {entry['category']}"
        rows.append(
            (
                f"prefer {entry['a']} to {entry['b']}{where}",
                f"{rounded(percent, 1)}%, χ²(1, N = {n}) = {chi2:g}",
                f"{rounded(entry['percent'], 1)}%, χ²(1, N = {entry['n']}) = "
                f"{rounded(entry['chi2'])}",
            )
        )
    return rows


def _thresholds(entries: list[dict[str, Any]]) -> list[FigureRow]:
    rows = []
    for entry in entries:
        key = (entry["specification"], entry["side"])
        pooled = entry["motion"] == entry["participant"] == "all"
        if not pooled or key not in THRESHOLDS:
            continue
        threshold = entry["threshold"]
        ends = f"[{signed(threshold['low'])}, {signed(threshold['high'])}]"
        rows.append(
            (
                f"threshold of {entry['side']} blends, {entry['specification']}",
                f"{signed(THRESHOLDS[key], 0)} frames",
                f"{signed(threshold['value'])} frames {ends}"
                if threshold["value"] is not None
                else entry["verdict"],
            )
        )
    return rows


def _ratings(entries: list[dict[str, Any]]) -> list[FigureRow]:
    rows = []
    for entry in entries:
        key = (str(entry["question"]).replace("-", " ").replace("_", " "), entry["test"])
        if key not in RATINGS:
            continue
        kind, value = RATINGS[key]
        theirs = {
            "p": lambda v: p_value(v),
            "F": lambda v: f"F(1, 48) = {rounded(v)}",
            "mean": lambda v: f"M = {rounded(v)}",
        }[kind](value)
        ours = {
            "p": lambda e: p_value(e["p"]),
            "F": lambda e: f"F({', '.join(map(str, e['df']))}) = {rounded(e['statistic'])}",
            "mean": lambda e: f"M = {rounded(e['mean'])}",
        }[kind](entry)
        rows.append((f"{entry['question']}: {entry['test']}", theirs, ours))
    return rows
