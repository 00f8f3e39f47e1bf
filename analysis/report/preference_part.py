"""The results of a preference study."""

from dataclasses import asdict
from typing import Any

import numpy as np
import pandas as pd

from analysis.bradley_terry import scale
from analysis.davidson import TiedScale, tied_scale
from analysis.mixed import MixedFit, mixed_logistic
from analysis.preferences import ALL, Contest, PreferenceCount, contests
from analysis.report.context import Context
from analysis.report.draw import GRID_COLOUR, INK, LONGER, PALE, canvas, quiet_y, shorten
from analysis.report.parts import Figure, Findings, ReportTable, Section
from analysis.report.scale_part import scale_section
from analysis.report.words import count as count_words
from analysis.report.words import interval, listing, p_value, rounded, sentence_case, share


def report_preference(context: Context) -> Findings:
    """Tests of every pair of methods, by category and motion; a scale of three or more."""
    methods = tuple(str(m) for m in context.protocol.get("methods") or ())
    found = contests(context.screened.main, methods)
    modelled = [(contest, model(contest)) for contest in found]
    sections = [_section(context, contest, fit) for contest, fit in modelled]
    document: dict[str, Any] = {"comparisons": [comparison(*entry) for entry in modelled]}
    named = tuple(sorted({name for contest in found for name in (contest.a, contest.b)}))
    trials, rng = context.screened.main, np.random.default_rng(context.seed)
    tied = bool(trials["tie"].any()) if "tie" in trials else False
    if tied:
        with_ties = tied_scale(trials, named, rng)
        sections.append(ties_section(context, with_ties, int(trials["tie"].sum())))
        document["with_ties"] = None if with_ties is None else asdict(with_ties)
    if len(named) > 2:
        decided = trials[~trials["tie"].astype(bool)] if tied else trials
        strengths = scale(decided, named, rng)
        sections.append(scale_section(context, strengths))
        document["scale"] = None if strengths is None else [asdict(s) for s in strengths]
    return Findings(tuple(sections), document)


def ties_section(context: Context, found: TiedScale | None, ties: int) -> Section:
    """What the answers that two methods are equal say, beside those that chose."""
    told = (
        f"{count_words(ties, 'answer')} of {len(context.screened.main):,} called the two equal. "
        "They choose neither, so that the tests above leave them out; Davidson's (1970) model of "
        "paired comparisons with ties takes them in."
    )
    if found is None:
        why = "It has no bounded estimate here: some method was never, or always, preferred."
        return Section("Ties", findings=(f"{told} {why}",))
    best, last = found.strengths[0], found.strengths[-1]
    difference = best.strength - last.strength
    sentence = (
        f"With ties the log odds of {best.method} against {last.method} are {rounded(difference)} "
        f"(strengths {rounded(best.strength)}, {interval(best.low, best.high)}, and "
        f"{rounded(last.strength)}, {interval(last.low, last.high)}; people resampled); between "
        f"equals the log odds of a tie against either are {rounded(found.tie)}, "
        f"{interval(found.low, found.high)}."
    )
    return Section("Ties", findings=(told, sentence))


def model(contest: Contest) -> MixedFit:
    """The mixed model of a contest."""
    table = contest.choices
    return mixed_logistic(
        table["participant"].to_numpy(), table["motion"].to_numpy(), table["chose_a"].to_numpy()
    )


def comparison(contest: Contest, fit: MixedFit) -> dict[str, Any]:
    """The comparison of report.json."""
    return {
        "a": contest.a,
        "b": contest.b,
        "category": contest.category,
        **asdict(contest.count),
        "ties": len(contest.ties),
        "mixed_model": asdict(fit),
        "per_motion": [
            {"motion": motion, **asdict(count)} for motion, count in contest.per_motion()
        ],
        "first_chosen": asdict(contest.first_chosen),
        "by_place": {name: asdict(count) for name, count in contest.by_place.items()},
    }


def preference_sentence(contest: Contest, alpha: float) -> str:
    """The pooled result in APA style."""
    count = contest.count
    if count.n == 0:
        return f"Nobody answered a comparison of {contest.a} and {contest.b}."
    where = "" if contest.category == ALL else f" for {contest.category} motions"
    significant = count.p is not None and count.p < alpha
    return (
        f"{sentence_case(contest.a)} was preferred to {contest.b}{where} in {count.prefer_a} of "
        f"{count.n} answers ({rounded(count.percent, 1)}%, "
        f"{interval(count.low, count.high, 1)}), χ²({count.df}, N = {count.n}) = "
        f"{rounded(count.chi2)}, {p_value(count.p)} (exact binomial test, "
        f"{p_value(count.binomial_p)}); the preference is "
        f"{'significant' if significant else 'not significant'} at α = {share(alpha)}."
    )


def mixed_sentence(contest: Contest, fit: MixedFit, alpha: float) -> str:
    """What the model that respects repeated measures says, and whether it agrees."""
    if fit.estimate is None:
        return f"The mixed model gives no estimate ({fit.method.partition(': ')[2]})."
    method, _, left_out = fit.method.partition("; of variance 0")
    odds = rounded(float(np.exp(np.clip(fit.estimate, -20, 20))))
    told = (
        f"{_with_effects(fit)} the log odds of choosing {contest.a} are "
        f"{rounded(fit.estimate)}, {interval(fit.low, fit.high)}, {p_value(fit.p)} "
        f"(odds {odds}; {method})."
    )
    if left_out:
        alike = [name for name, sd in _standard_deviations(fit) if sd == 0]
        told += (
            f" {sentence_case(listing(alike))} did not differ by more than chance, and the model "
            "was fitted without that."
        )
    pooled = contest.count.p is not None and contest.count.p < alpha
    own = fit.p is not None and fit.p < alpha
    if pooled == own:
        return told
    return told + (
        " The two tests disagree: the pooled test finds a preference, but it takes the answers of "
        "one person as independent; trust the mixed model."
        if pooled
        else " The two tests disagree: the mixed model finds a preference where the pooled test, "
        "which averages over people and motions, does not."
    )


def _with_effects(fit: MixedFit) -> str:
    """The random effects that were fitted: an SD stands for each."""
    effects = [name for name, _ in _standard_deviations(fit)]
    if not effects:
        return "Without random effects, which these answers cannot tell,"
    return f"With {listing(effects)} as random effects"


def _standard_deviations(fit: MixedFit) -> list[tuple[str, float]]:
    """The effects that were fitted with their standard deviations."""
    held = (("people", fit.sd_people), ("motions", fit.sd_motions))
    return [(name, sd) for name, sd in held if sd is not None]


def bias_sentence(contest: Contest, alpha: float) -> str:
    """Whether the clip shown first was favoured."""
    count = contest.first_chosen
    if contest.one_sided:
        first = contest.a if contest.choices["a_first"].iloc[0] else contest.b
        return (
            f"{sentence_case(first)} always came first: a bias of place and a preference for it "
            "are confounded, and these answers cannot tell them apart."
        )
    biased = count.p is not None and count.p < alpha
    places = contest.by_place
    return (
        f"The clip shown first was chosen in {rounded(count.percent, 1)}% of answers, "
        f"{interval(count.low, count.high, 1)}, χ²(1, N = {count.n}) = {rounded(count.chi2)}, "
        f"{p_value(count.p)}: {'a' if biased else 'no significant'} bias of place. "
        f"{sentence_case(contest.a)} was chosen in {rounded(places['first'].percent, 1)}% of the "
        f"{places['first'].n} trials that showed it first and in "
        f"{rounded(places['second'].percent, 1)}% of the {places['second'].n} that showed it "
        "second."
    )


def _title(contest: Contest) -> str:
    title = f"{sentence_case(contest.a)} against {contest.b}"
    return title if contest.category == ALL else f"{title}: {contest.category}"


def _section(context: Context, contest: Contest, fit: MixedFit) -> Section:
    stem = f"{context.stem}-{contest.a}-{contest.b}-{contest.category}"
    rows = [("all motions", contest.count), *contest.per_motion()]
    findings = [
        preference_sentence(contest, context.alpha),
        mixed_sentence(contest, fit, context.alpha),
    ]
    if contest.category == ALL:
        findings.append(bias_sentence(contest, context.alpha))
    return Section(
        _title(contest),
        findings=tuple(findings),
        figures=(_figure(stem, contest, rows),),
        tables=(_table(stem, contest, rows),),
    )


def _table(stem: str, contest: Contest, rows: list[tuple[str, PreferenceCount]]) -> ReportTable:
    data = pd.DataFrame([{"motion": motion, **asdict(count)} for motion, count in rows])
    shown = pd.DataFrame(
        {
            "Motion": [motion for motion, _ in rows],
            "n": [str(count.n) for _, count in rows],
            f"Chose {contest.a}": [str(count.prefer_a) for _, count in rows],
            "%": [rounded(count.percent, 1) for _, count in rows],
            "95% interval": [
                f"{rounded(count.low, 1)} to {rounded(count.high, 1)}" for _, count in rows
            ],
            "χ²(1)": [rounded(count.chi2) for _, count in rows],
            "p": [p_value(count.p).removeprefix("p ").removeprefix("= ") for _, count in rows],
            "exact p": [
                p_value(count.binomial_p).removeprefix("p ").removeprefix("= ") for _, count in rows
            ],
        }
    )
    return ReportTable(
        stem,
        f"Answers that chose {contest.a} over {contest.b}.",
        data,
        shown,
        "χ² against one half; the interval is Wilson's.",
    )


def _figure(stem: str, contest: Contest, rows: list[tuple[str, PreferenceCount]]) -> Figure:
    kept = [(motion, count) for motion, count in rows if count.percent is not None]
    with canvas(7.2, 0.8 + 0.3 * len(kept)) as drawn:
        axis = drawn.figure.subplots()
        axis.axvline(50, color=PALE, linewidth=1, linestyle=(0, (4, 3)))
        for place, (_, count) in enumerate(kept):
            colour = INK if place == 0 else LONGER
            axis.axhline(place, color=GRID_COLOUR, linewidth=0.7, zorder=0)
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
