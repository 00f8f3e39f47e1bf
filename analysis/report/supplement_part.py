"""What stands beside the thresholds of an odd-pair study, as tables and sentences."""

from typing import Any

import pandas as pd

from analysis.preferences import preference
from analysis.report.context import Context
from analysis.report.parts import ReportTable, Section
from analysis.report.words import interval, p_value, rounded, share, signed
from analysis.supplements import Difference, Shown, Supplement
from analysis.thresholds import ALL


def beside_section(context: Context, found: list[Supplement]) -> Section:
    """Other fits of the same trials: a threshold that rests on one method alone is shaky."""
    rows = [row for entry in found for row in _rows(entry)]
    if not rows:
        return Section("Other fits of the same trials", text=("No threshold is identifiable.",))
    data = pd.DataFrame(rows)
    shown = pd.DataFrame(
        {
            "Side": data["side"],
            "Motion": data["motion"],
            "By": data["method"],
            "Threshold": data["value"].map(signed),
            "95% interval": data["ends"],
        }
    )
    findings = tuple(
        f"The Weber fraction d/k of {entry.side} blends is {rounded(abs(entry.weber_fraction))}."
        for entry in found
        if entry.motion == ALL and entry.weber_fraction is not None
    )
    table = ReportTable(
        f"{context.stem}-beside",
        "The same trials by other methods (frames, signed).",
        data.drop(columns="ends"),
        shown,
        "Bias-reduced: Jeffreys’ penalty against the steepness that few or adaptive trials "
        "feign. Random threshold: all people at once, thresholds normal among them, with their "
        "SD. d′ of 1 is a proportion of .760 if each pair is one observation, of .573 if the "
        "two clips of each pair are compared first.",
    )
    return Section("Other fits of the same trials", findings=findings, tables=(table,))


def _rows(entry: Supplement) -> list[dict[str, Any]]:
    """One row a method; the numbers as they are."""
    common = {"side": entry.side, "specification": entry.specification, "motion": entry.motion}
    none = float("nan")
    rows = []
    if entry.bias_reduced:
        value = {"value": entry.bias_reduced["value"], "low": none, "high": none, "ends": "–"}
        rows.append({**common, "method": "bias-reduced fit", **value})
    if entry.random_threshold:
        fit = entry.random_threshold
        name = f"random threshold (SD {rounded(fit['sd'])})"
        rows.append({**common, "method": name, **_numbers(fit)})
    for told in entry.d_prime:
        name = f"d′ = 1, {told['rule']}"
        rows.append({**common, "method": name, **_numbers(told)})
    if entry.second_opinion:
        other = entry.second_opinion
        rows.append({**common, "method": other["method"], **_numbers(other)})
    return rows


def _numbers(told: dict[str, Any]) -> dict[str, Any]:
    """Value and ends, nan where there is none, and the ends in words."""
    held = {
        key: float("nan") if told[key] is None else told[key] for key in ("value", "low", "high")
    }
    words = [
        str(told[f"{end}_reason"]).partition(",")[0]
        if f"{end}_reason" in told
        else signed(held[end])
        for end in ("low", "high")
    ]
    return {**held, "ends": " to ".join(words) if held["value"] == held["value"] else "–"}


def difference_section(
    context: Context, tests: list[Difference], stem: str | None = None
) -> Section:
    """Whether motions, sides and specifications share one psychometric function."""
    findings = tuple(_difference(test, context.alpha) for test in tests)
    data = pd.DataFrame([test.as_dict() for test in tests])
    shown = pd.DataFrame(
        {
            "Between": [test.between for test in tests],
            "Side": [test.side for test in tests],
            "Groups": [", ".join(test.groups) for test in tests],
            "χ²": [rounded(test.test.statistic) for test in tests],
            "df": [str(test.test.df) for test in tests],
            "p": [p_value(test.test.p).removeprefix("p ").removeprefix("= ") for test in tests],
        }
    )
    note = (
        "Likelihood-ratio tests of one function against one for each group. They take trials as "
        "independent: where people differ, a p just below α is weak evidence."
    )
    table = ReportTable(
        f"{stem or context.stem}-differences", "Is the function the same?", data, shown, note
    )
    return Section("Differences", findings=findings, tables=(table,))


def _difference(test: Difference, alpha: float) -> str:
    where = "" if test.side == ALL else f" of {test.side} blends"
    differ = test.test.p < alpha
    return (
        f"The psychometric functions{where} {'differ' if differ else 'do not differ'} "
        f"significantly between {test.between}, χ²({test.test.df}) = "
        f"{rounded(test.test.statistic)}, {p_value(test.test.p)}."
    )


def shown_section(context: Context, found: list[Shown]) -> Section:
    """Fits against what was shown instead of nominal blend length."""
    data = pd.DataFrame(
        [
            {
                "measure": fit.measure,
                "side": fit.side,
                "levels": fit.levels,
                **fit.threshold,
                "gain": fit.gain,
                "verdict": fit.verdict,
            }
            for fit in found
        ]
    )
    shown = pd.DataFrame(
        {
            "Measure": data["measure"],
            "Side": data["side"],
            "Levels": data["levels"].map(str),
            "Threshold": data["value"].map(lambda v: rounded(v, 4)),
            "95% interval": [
                f"{rounded(fit.threshold['low'], 4)} to {rounded(fit.threshold['high'], 4)}"
                for fit in found
            ],
            "Gain": data["gain"].map(rounded),
        }
    )
    note = (
        "The level is the difference between the odd clip and the reference in a measure of the "
        "manifest, in its own unit. Gain: log likelihood above that of the fit to blend length on "
        "the same trials; a positive gain means that the measure says more than the length does."
    )
    table = ReportTable(f"{context.stem}-shown", "Thresholds in what was shown.", data, shown, note)
    return Section("Against what was shown", tables=(table,))


def answer_bias_section(trials: pd.DataFrame) -> Section:
    """Whether one answer was favoured, and whether the odd clip's place mattered."""
    told = []
    if "response" in trials:
        answer = pd.to_numeric(trials["response"], errors="coerce").dropna()
        first = preference(int((answer == 1).sum()), len(answer))
        told.append(
            f"The first pair was named in {rounded(first.percent, 1)}% of {first.n} answers, "
            f"{interval(first.low, first.high, 1)}, {p_value(first.p)}."
        )
    for column, words in (("odd_pair", "the odd pair came {}"), ("odd_position", "{} in its pair")):
        if column not in trials or trials[column].isna().all():
            continue
        right = trials.groupby(column)["correct"].mean()
        names = {1: "first", 2: "second"} if column == "odd_pair" else {1: "left", 2: "right"}
        parts = [
            f"{share(value)} when {words.format(names.get(int(key), key))}"
            if column == "odd_pair"
            else f"{share(value)} when the odd clip was {words.format(names.get(int(key), key))}"
            for key, value in right.items()
        ]
        told.append(f"Proportion right: {', '.join(parts)}.")
    return Section("Bias of answers", text=(" ".join(told),) if told else ("Not recorded.",))
