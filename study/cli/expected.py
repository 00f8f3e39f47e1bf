"""What a study of a protocol's [observer] comes to: measured in one, expected over many.

Shares and ratings as a report counts them; a threshold by the fit that a report gives.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import pandas as pd

    from study.protocol.protocol import Protocol

Held = Iterator[tuple[str, float, Callable[["pd.DataFrame"], float]]]
_MIDDLE = (2.5, 97.5)  # percent: between them lie 95 of 100 studies


def _preferences(protocol: "Protocol", observer: Any) -> Held:
    """Of each two methods the share of answers for the first, by category where that decides."""
    nested = {k: v for k, v in observer.prefer.items() if isinstance(v, Mapping)}
    for category, shares in (nested or {"": observer.prefer}).items():
        for a, b in combinations(protocol.file.methods, 2):
            odds = shares[a] + shares[b]
            where = f", {category}" if category else ""
            yield f"{a} over {b}{where}", shares[a] / odds if odds else 0.5, _chose(a, b, category)


def _chose(a: str, b: str, category: str) -> Callable[["pd.DataFrame"], float]:
    def share(trials: "pd.DataFrame") -> float:
        of = trials[trials["chosen_method"].notna()]
        of = of[of["first_method"].isin((a, b)) & of["second_method"].isin((a, b))]
        if category:
            of = of[of["category"] == category]
        return float((of["chosen_method"] == a).mean())

    return share


def _ratings(protocol: "Protocol", observer: Any) -> Held:
    """The mean rating of each question, by method or comparing them."""
    for question, methods in observer.rate.items():
        for method, spread in methods.items():
            yield f"{question}, {method}", spread.mean, _mean_rating(question, method)
    for question, spread in observer.compare.items():
        yield question, spread.mean, _mean_rating(question, None)


def _mean_rating(question: str, method: str | None) -> Callable[["pd.DataFrame"], float]:
    def mean(trials: "pd.DataFrame") -> float:
        of = trials[trials["question"] == question]
        own = of["method"].isna() if method is None else of["method"] == method
        return float(of[own]["rating"].astype(float).mean())

    return mean


def _naturalness(protocol: "Protocol", observer: Any) -> Held:
    """The share of each method's clips that is called natural."""
    for method, share in observer.natural.items():
        yield f"natural, {method}", share, _called_natural(method)


def _called_natural(method: str) -> Callable[["pd.DataFrame"], float]:
    def share(trials: "pd.DataFrame") -> float:
        of = trials[trials["clip"].str.endswith(f"/{method}")]  # as a clip of no set is called
        return float((of["response"] == "natural").mean())

    return share


_HELD: Mapping[str, Callable[["Protocol", Any], Held]] = {
    "preferences": _preferences,
    "ratings": _ratings,
    "naturalness": _naturalness,
}


def measured(protocol: "Protocol", analysis: str, study: Mapping[str, Any]) -> dict[str, float]:
    """What one simulated study says of each thing that the protocol's observer holds."""
    if "estimates" in study:
        return {f"threshold {e.side}": e.value for e in study["estimates"] if e.ok}
    observer = protocol.file.observer
    rows = _HELD[analysis](protocol, observer) if observer else ()
    return {what: of(study["table"]) for what, _, of in rows}


def expected(
    protocol: "Protocol", analysis: str, studies: Sequence[Mapping[str, Any]]
) -> list[dict[str, Any]]:
    """Each thing that the observer holds: its truth, and mean, SD and middle 95 % of studies."""
    observer: Any = protocol.file.observer
    if observer is None:
        return []
    if analysis in _HELD:
        truths = {what: truth for what, truth, _ in _HELD[analysis](protocol, observer)}
    else:
        truths = {f"threshold {side}": value for side, value in observer.sides().items()}
    told = []
    for what, truth in truths.items():
        found = np.array([s["measured"][what] for s in studies if what in s["measured"]], float)
        row: dict[str, Any] = {"what": what, "truth": truth, "studies": len(found)}
        if len(found) > 1:
            low, high = (float(v) for v in np.percentile(found, _MIDDLE))
            row |= {"mean": float(found.mean()), "sd": float(found.std(ddof=1)),
                    "low": low, "high": high}  # fmt: skip
        told.append(row)
    return told
