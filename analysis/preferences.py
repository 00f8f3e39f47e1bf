"""Which of two was preferred: the tests against one half.

χ² with one degree of freedom as in the dissertation (V.2.2), the exact binomial test, and the
interval of Wilson (1927). Answers that the two are equal are ties: they decide nothing between two
methods, are counted beside, and enter the model of Davidson (1970).
"""

from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from scipy.stats import binom, binomtest, chi2

from analysis.psychometric.functions import Array

ALL = "all"


@dataclass(frozen=True)
class PreferenceCount:
    """`prefer_a` of `n` answers chose a; percentages with the ends of the 95 % interval."""

    n: int
    prefer_a: int
    percent: float | None
    low: float | None
    high: float | None
    chi2: float | None
    df: int
    p: float | None
    binomial_p: float | None


def preference(prefer_a: int, n: int, level: float = 0.95) -> PreferenceCount:
    """Everything about one count; the numbers are None when nobody answered."""
    if n == 0:
        return PreferenceCount(0, 0, None, None, None, None, 1, None, None)
    test = binomtest(prefer_a, n, 0.5)
    ends = test.proportion_ci(level, method="wilson")
    statistic = chi_square(prefer_a, n)
    return PreferenceCount(
        n=n,
        prefer_a=prefer_a,
        percent=100 * prefer_a / n,
        low=100 * float(ends.low),
        high=100 * float(ends.high),
        chi2=statistic,
        df=1,
        p=float(chi2.sf(statistic, 1)),
        binomial_p=float(test.pvalue),
    )


def chi_square(prefer_a: int, n: int) -> float:
    """χ²(1) of a count against one half: Σ (observed − n/2)² / (n/2) over the two choices."""
    return (2 * prefer_a - n) ** 2 / n


@dataclass(frozen=True, eq=False)
class Contest:
    """The answered trials of two methods; `choices` has columns participant, motion, chose_a
    (0 or 1), a_first (0 or 1) of those that chose, `ties` the columns of those that did not."""

    a: str
    b: str
    category: str
    choices: pd.DataFrame
    ties: pd.DataFrame = field(default_factory=pd.DataFrame)

    @property
    def one_sided(self) -> bool:
        """Whether one method always came first: its place and itself cannot be told apart."""
        return len(self.choices) > 0 and self.choices["a_first"].nunique() == 1

    @property
    def count(self) -> PreferenceCount:
        return preference(int(self.choices["chose_a"].sum()), len(self.choices))

    @property
    def first_chosen(self) -> PreferenceCount:
        """How often the clip shown first (or left) was chosen: the bias of place."""
        same = self.choices["chose_a"] == self.choices["a_first"]
        return preference(int(same.sum()), len(same))

    @property
    def by_place(self) -> dict[str, PreferenceCount]:
        """Choices of a when it came first, and when it came second."""
        parts = {"first": 1, "second": 0}
        return {
            name: preference(int(part["chose_a"].sum()), len(part))
            for name, value in parts.items()
            for part in [self.choices[self.choices["a_first"] == value]]
        }

    def per_motion(self) -> list[tuple[str, PreferenceCount]]:
        return [
            (str(motion), preference(int(part["chose_a"].sum()), len(part)))
            for motion, part in self.choices.groupby("motion", sort=True)
        ]


def contests(trials: pd.DataFrame, order: tuple[str, ...] = ()) -> list[Contest]:
    """Answered trials split by pair of methods and category (`all` first).

    `order` names the protocol's methods: the one named earlier is `a`.
    """
    tie = trials["tie"].astype(bool) if "tie" in trials else trials["chosen_method"].isin([])
    answered = trials[trials["chosen_method"].notna() | tie]
    tie = tie[answered.index]
    first, second = answered["first_method"].astype(str), answered["second_method"].astype(str)
    named = list(order) + sorted((set(first) | set(second)) - set(order))
    place = {method: number for number, method in enumerate(named)}
    swapped = first.map(place) > second.map(place)
    a, b = first.where(~swapped, second), second.where(~swapped, first)
    choices = pd.DataFrame(
        {
            "participant": answered["participant"].astype(str),
            "motion": _column(answered, "motion"),
            "category": _column(answered, "category"),
            "chose_a": (answered["chosen_method"].astype(str) == a).astype(int),
            "a_first": (~swapped).astype(int),
            "a": a,
            "b": b,
            "tie": tie,
        }
    )
    found: list[Contest] = []
    pairs = sorted(set(zip(a, b, strict=True)), key=lambda pair: (place[pair[0]], place[pair[1]]))
    for pair in pairs:
        both = choices[(choices["a"] == pair[0]) & (choices["b"] == pair[1])]
        found.append(_contest(*pair, ALL, both))
        categories = sorted(set(both["category"]) - {""})
        for category in categories if len(categories) > 1 else []:
            found.append(_contest(*pair, category, both[both["category"] == category]))
    return found


def _contest(a: str, b: str, category: str, answers: pd.DataFrame) -> Contest:
    tied = answers["tie"].astype(bool)
    return Contest(a, b, category, answers[~tied], answers[tied])


def _column(table: pd.DataFrame, name: str) -> pd.Series:
    if name not in table:
        return pd.Series("", table.index, dtype=object)
    return table[name].fillna("").astype(str)


def critical(n: int, alpha: float) -> int:
    """Smallest majority of `n` answers that the exact two-sided test finds significant."""
    majorities: Array = np.arange(n // 2 + 1, n + 1)
    significant = majorities[2 * binom.sf(majorities - 1, n, 0.5) < alpha]
    return int(significant[0]) if len(significant) else n + 1
