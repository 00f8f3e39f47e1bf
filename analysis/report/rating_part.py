"""The results of a rating study."""

from typing import Any

import numpy as np
import pandas as pd

from analysis.ratings import (
    COMPARISON_MIDPOINT,
    Question,
    RatingTest,
    all_tests,
    comparison_test,
    comparisons,
    questions,
)
from analysis.report.context import Context
from analysis.report.draw import SERIES, canvas
from analysis.report.parts import Figure, Findings, ReportTable, Section
from analysis.report.words import interval, p_value, rounded, sentence_case, share


def report_rating(context: Context) -> Findings:
    """Each question's order test, grouping, tests of the methods; then the comparisons."""
    rng = np.random.default_rng(context.seed)
    methods = tuple(str(m) for m in context.protocol.get("methods") or ())
    main = context.screened.main
    sections, told = [], []
    for question in questions(main, methods):
        tests = all_tests(question, context.alpha, rng)
        sections.append(_question_section(context, question, tests))
        told += tests
    compared = comparisons(main)
    tests = [comparison_test(name, ratings, rng) for name, ratings in compared]
    if tests:
        sections.append(_comparison_section(context, tests, compared))
    return Findings(tuple(sections), {"ratings": [test.as_dict() for test in [*told, *tests]]})


SYMBOLS = {"rank-sum": "U", "signed-rank": "V", "ANOVA": "F", "ordinal": "z"}
_EFFECTS = {
    "rank-biserial correlation": "r_rb",
    "partial η²": "partial η²",
    "log odds ratio": "log odds ratio",
}


def apa(test: RatingTest) -> str:
    """`V = 40, p = .039, r_rb = .78, 95% CI [.30, 1.00]`."""
    if test.p is None:
        return test.note
    kind = next(symbol for name, symbol in SYMBOLS.items() if test.test.startswith(name))
    df = "" if test.df is None else f"({', '.join(map(str, test.df))})"
    digits = 0 if kind in "UV" and test.statistic == round(test.statistic or 0) else 2
    return (
        f"{kind}{df} = {rounded(test.statistic, digits)}, {p_value(test.p)}, "
        f"{_EFFECTS[test.effect]} = {rounded(test.effect_size)}, {interval(test.low, test.high)}"
    )


def _question_section(context: Context, question: Question, tests: list[RatingTest]) -> Section:
    stem = f"{context.stem}-{question.name}-{'-'.join(question.methods)}"
    name = f"{sentence_case(question.name)}: {question.methods[0]} against {question.methods[1]}"
    return Section(
        name,
        text=_order_text(context, tests),
        findings=tuple(_sentences(context, question, tests)),
        figures=(_figure(stem, question),),
        tables=(_means(stem, question), _table(f"{stem}-tests", tests)),
    )


def _order_text(context: Context, tests: list[RatingTest]) -> tuple[str, ...]:
    order = [test for test in tests if test.test == "rank-sum, order"]
    if not order:
        return ("All people saw one order, so that an order effect cannot be told apart.",)
    told = "; ".join(f"{test.groups[0]} against {test.groups[1]}, {apa(test)}" for test in order)
    grouped = all(test.p is None or test.p >= context.alpha for test in order)
    verdict = (
        "Neither is significant, so the orders were grouped and the methods compared over all "
        "people (the grouping of Wang 2005, IV.4.1)."
        if grouped
        else "The order of presentation mattered, so the methods were compared within each order."
    )
    return (f"Order of presentation, tested first by rank-sum: {told}. {verdict}",)


def _sentences(context: Context, question: Question, tests: list[RatingTest]) -> list[str]:
    a, b = question.methods
    told = []
    for test in tests:
        if test.test == "signed-rank, method" and test.p is None:
            told.append(
                f"{sentence_case(question.name)} of {b} and of {a} do not differ: "
                f"{apa(test)} {'person' if len(question.people) == 1 else 'people'}."
            )
        elif test.test == "signed-rank, method":
            where = test.groups[0].removesuffix(a).rstrip(": ")
            significant = test.p is not None and test.p < context.alpha
            higher = b if (test.effect_size or 0) > 0 else a
            told.append(
                f"{sentence_case(question.name)} of {b} (M = {rounded(question.b.mean())}, "
                f"SD = {rounded(_sd(question.b))}) and of {a} (M = {rounded(question.a.mean())}, "
                f"SD = {rounded(_sd(question.a))})"
                + (f", among people who saw {where}," if where else "")
                + (
                    f" differed significantly, {higher} being rated higher"
                    if significant
                    else " did not differ significantly"
                )
                + f": Wilcoxon signed-rank test ({test.note}), {apa(test)}."
            )
        if test.test.startswith("ordinal") and test.statistic is not None:
            told.append(
                f"An ordinal regression agrees on the direction and size: {apa(test)}, for a "
                f"higher rating of {b} than of {a}."
                if np.sign(test.effect_size or 0) == np.sign(question.b.mean() - question.a.mean())
                else f"Ordinal regression: {apa(test)}."
            )
    return told


def _sd(values: Any) -> float | None:
    return float(values.std(ddof=1)) if len(values) > 1 else None


def _means(stem: str, question: Question) -> ReportTable:
    rows = []
    for method, ratings in zip(question.methods, (question.a, question.b), strict=True):
        for name in ["all", *question.order_names]:
            kept = ratings if name == "all" else ratings[question.of_order(name)]
            rows.append(
                {"method": method, "order": name or "–", "n": len(kept), "mean": kept.mean(),
                 "sd": _sd(kept), "median": float(np.median(kept))}
            )  # fmt: skip
    data = pd.DataFrame(rows)
    shown = pd.DataFrame(
        {
            "Method": data["method"],
            "Order": data["order"],
            "n": data["n"].map(str),
            "Mean": data["mean"].map(rounded),
            "SD": data["sd"].map(rounded),
            "Median": data["median"].map(lambda v: rounded(v, 1)),
        }
    )
    return ReportTable(f"{stem}-means", f"Ratings of {question.name}.", data, shown)


def _table(name: str, tests: list[RatingTest]) -> ReportTable:
    data = pd.DataFrame([test.as_dict() for test in tests])
    shown = pd.DataFrame(
        {
            "Test": [test.test for test in tests],
            "Groups": [" / ".join(test.groups) for test in tests],
            "Statistic": [rounded(test.statistic) for test in tests],
            "df": ["" if t.df is None else ", ".join(map(str, t.df)) for t in tests],
            "p": [p_value(test.p).removeprefix("p ").removeprefix("= ") for test in tests],
            "Effect": [rounded(test.effect_size) for test in tests],
            "95% interval": [f"{rounded(t.low)} to {rounded(t.high)}" for t in tests],
        }
    )
    return ReportTable(
        name,
        "All tests of this question.",
        data,
        shown,
        "Effects: rank-biserial correlation (rank tests, intervals by resampling people), partial "
        "η² (analyses of variance, intervals from the noncentral F), log odds ratio (ordinal "
        "regression). The analysis of variance with ratings taken as independent is the "
        "dissertation's; the mixed design respects that each person rated both methods.",
    )


def _figure(stem: str, question: Question) -> Figure:
    top = np.arange(
        min(question.a.min(), question.b.min()), max(question.a.max(), question.b.max()) + 1
    )
    with canvas(7.2, 2.4) as drawn:
        axis = drawn.figure.subplots()
        for place, (method, ratings) in enumerate(
            zip(question.methods, (question.a, question.b), strict=True)
        ):
            people = [int((np.round(ratings) == value).sum()) for value in top]
            axis.bar(top + (place - 0.5) * 0.38, people, 0.36, color=SERIES[place], label=method)
        axis.set_xticks(top)
        axis.set_xlabel(f"rating of {question.name}")
        axis.set_ylabel("people")
        axis.legend(fontsize=8.5)
    return Figure(stem, f"How often each rating of {question.name} was given.", drawn.svg)


def _comparison_section(
    context: Context, tests: list[RatingTest], compared: list[tuple[str, Any]]
) -> Section:
    data = pd.DataFrame([test.as_dict() for test in tests])
    shown = pd.DataFrame(
        {
            "Comparison": [test.question for test in tests],
            "n": [str(test.more["people"]) for test in tests],
            "Mean": [rounded(test.more["mean"]) for test in tests],
            "Std. dev.": [rounded(test.more["sd"]) for test in tests],
            "V": [rounded(test.statistic, 1) for test in tests],
            "p": [p_value(test.p).removeprefix("p ").removeprefix("= ") for test in tests],
            "Effect": [rounded(test.effect_size) for test in tests],
            "95% interval": [f"{rounded(t.low)} to {rounded(t.high)}" for t in tests],
        }
    )
    told = tuple(
        f"{sentence_case(test.question)}: M = {rounded(test.more['mean'])}, "
        f"SD = {rounded(test.more['sd'])} on a scale from 0 to 4, "
        + (
            "which nobody left"
            if test.p is None
            else "which differs significantly from its midpoint"
            if test.p is not None and test.p < context.alpha
            else "which does not differ significantly from its midpoint"
        )
        + (f" ({apa(test)})." if test.p is None else f" ({apa(test)}; {test.note}).")
        for test in tests
    )
    return Section(
        "Direct comparisons",
        findings=told,
        tables=(
            ReportTable(
                f"{context.stem}-comparisons",
                "Ratings that compare the methods (as Table IV.3 of the dissertation).",
                data,
                shown,
                f"Signed-rank tests against the midpoint, {share(COMPARISON_MIDPOINT, 0)}.",
            ),
        ),
    )
