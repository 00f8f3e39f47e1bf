"""Ratings of two methods seen in two orders: the tests of Wang IV.4.1 and better ones.

The order test comes first: for each method the two order groups are compared by rank-sum
(O1M1 against O2M1, O1M2 against O2M2; the dissertation prints O2M1 against O2M2 for the second,
which compares methods). If neither is significant the orders are grouped, and a signed-rank test
compares the methods over all people; otherwise it compares them within each order.
"""

from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

import numpy as np
import pandas as pd

from analysis import anova
from analysis.ordinal import Ordinal, ordinal
from analysis.psychometric.bootstrap import percentile_interval
from analysis.psychometric.functions import Array
from analysis.ranks import RankTest, biserial_signed, biserial_sum, rank_sum, signed_rank

COMPARISON_MIDPOINT = 2.0  # of the scale 0-4 on which two methods are compared (Table IV.3)
RESAMPLES = 2000


@dataclass(frozen=True)
class RatingTest:
    """One test of a question, as report.json has it."""

    question: str
    test: str
    groups: tuple[str, ...]
    statistic: float | None
    df: tuple[int, ...] | None
    p: float | None
    effect_size: float | None
    low: float | None
    high: float | None
    effect: str
    note: str = ""
    more: dict[str, Any] = field(default_factory=dict)

    def as_dict(self) -> dict[str, Any]:
        return {
            "question": self.question,
            "test": self.test,
            "groups": list(self.groups),
            "statistic": self.statistic,
            "df": None if self.df is None else list(self.df),
            "p": self.p,
            "effect_size": self.effect_size,
            "low": self.low,
            "high": self.high,
            "effect": self.effect,
            "note": self.note,
            **self.more,
        }


@dataclass(frozen=True, eq=False)
class Question:
    """Two methods' ratings by the same people: `a` and `b` (P,), the order each person saw."""

    name: str
    methods: tuple[str, str]
    people: tuple[str, ...]
    a: Array
    b: Array
    orders: tuple[str, ...]

    @property
    def order_names(self) -> list[str]:
        return sorted(set(self.orders))

    def of_order(self, name: str) -> Array:
        return np.array([order == name for order in self.orders])

    @property
    def order_sign(self) -> Array:
        """−1 for the first order, 1 for the other."""
        return np.where(self.of_order(self.order_names[0]), -1.0, 1.0)


def questions(trials: pd.DataFrame, order: tuple[str, ...] = ()) -> list[Question]:
    """Every question asked of two methods; people who rated only one are left out.

    A person's ratings of several motions are averaged. `order` names the protocol's methods.
    """
    rated = trials[_text(trials, "method") != ""]
    found = []
    for question, part in rated.groupby("question", sort=False):
        wide = part.pivot_table(index="participant", columns="method", values="rating")
        seen = part.assign(order=_text(part, "order")).groupby("participant")["order"].first()
        named = [m for m in order if m in wide] + sorted(set(wide.columns) - set(order))
        for a, b in combinations(named, 2):
            both = wide[[a, b]].dropna()
            found.append(
                Question(
                    str(question),
                    (str(a), str(b)),
                    tuple(map(str, both.index)),
                    both[a].to_numpy(float),
                    both[b].to_numpy(float),
                    tuple(str(seen[person]) for person in both.index),
                )
            )
    return found


def comparisons(trials: pd.DataFrame) -> list[tuple[str, Array]]:
    """Ratings (P,) of each question that compares the methods (its rows name no method)."""
    asked = trials[_text(trials, "method") == ""]
    return [
        (str(question), part.groupby("participant")["rating"].mean().to_numpy(float))
        for question, part in asked.groupby("question", sort=False)
    ]


def _text(table: pd.DataFrame, column: str) -> pd.Series:
    if column not in table:
        return pd.Series("", table.index, dtype=object)
    return table[column].fillna("").astype(str)


def order_tests(question: Question, rng: np.random.Generator) -> list[RatingTest]:
    """Rank-sum of the two orders, for each method."""
    first, second = question.order_names
    kept = question.of_order(first)
    tests = []
    for method, ratings in zip(question.methods, (question.a, question.b), strict=True):
        x, y = ratings[kept], ratings[~kept]
        low, high = _resampled_sum(x, y, rng)
        groups = (f"{first}: {method}", f"{second}: {method}")
        tests.append(_ranked(question.name, "rank-sum, order", groups, rank_sum(x, y), low, high))
    return tests


def method_tests(question: Question, grouped: bool, rng: np.random.Generator) -> list[RatingTest]:
    """Signed-rank of the methods over all people when `grouped`, else within each order."""
    parts = (
        [("", np.ones(len(question.people), bool))]
        if grouped
        else [(f"{name}: ", question.of_order(name)) for name in question.order_names]
    )
    tests = []
    for label, kept in parts:
        difference = question.b[kept] - question.a[kept]
        low, high = _resampled_signed(difference, rng)
        groups = (label + question.methods[0], label + question.methods[1])
        test = signed_rank(difference)
        tests.append(_ranked(question.name, "signed-rank, method", groups, test, low, high))
    return tests


def _ranked(
    question: str,
    name: str,
    groups: tuple[str, ...],
    test: RankTest,
    low: float | None,
    high: float | None,
) -> RatingTest:
    if test.p is None:  # nothing to rank: an interval would claim certainty
        low = high = None
    return RatingTest(
        question, name, groups, test.statistic, None, test.p, test.effect_size, low, high,
        "rank-biserial correlation", test.how, {"n": test.n, "exact": test.exact},
    )  # fmt: skip


def _resampled_sum(x: Array, y: Array, rng: np.random.Generator) -> tuple[float, float]:
    if len(x) == 0 or len(y) == 0:
        return -1.0, 1.0
    first = x[rng.integers(len(x), size=(RESAMPLES, len(x)))]
    second = y[rng.integers(len(y), size=(RESAMPLES, len(y)))]
    return percentile_interval(biserial_sum(first, second))


def _resampled_signed(difference: Array, rng: np.random.Generator) -> tuple[float, float]:
    if len(difference) == 0:
        return -1.0, 1.0
    picked = rng.integers(len(difference), size=(RESAMPLES, len(difference)))
    return percentile_interval(biserial_signed(difference[picked]))


def analyses_of_variance(question: Question) -> list[RatingTest]:
    """His two-way ANOVA of ratings taken as independent, and the mixed-design one beside it."""
    order, people = question.order_sign, len(question.people)
    stacked = np.concatenate([question.a, question.b])
    method = np.repeat([-1.0, 1.0], people)
    tests = []
    for name, effects in (
        ("ANOVA, ratings independent", anova.independent(stacked, method, np.tile(order, 2))),
        ("ANOVA, mixed design", anova.split_plot(question.a, question.b, order)),
    ):
        for effect in effects:
            known = np.isfinite(effect.p)
            groups = {
                "method": question.methods,
                "order": tuple(question.order_names),
            }.get(effect.name, (*question.methods, *question.order_names))
            tests.append(
                RatingTest(
                    question.name,
                    f"{name}: {effect.name}",
                    groups,
                    effect.statistic if known else None,
                    effect.df,
                    effect.p if known else None,
                    effect.effect_size if known else None,
                    effect.low if known else None,
                    effect.high if known else None,
                    "partial η²",
                    "" if known else "no test: the ratings do not differ",
                    {"mean_square": effect.mean_square},
                )
            )
    return tests


def ordinal_test(question: Question) -> RatingTest:
    """The ordinal regression: log odds of a higher rating under the second method."""
    people = np.arange(len(question.people))
    found: Ordinal = ordinal(
        np.concatenate([question.a, question.b]),
        np.repeat([-1.0, 1.0], len(people)),
        np.tile(question.order_sign, 2),
        np.tile(people, 2),
    )
    return RatingTest(
        question.name, "ordinal regression: method", question.methods, found.z, None, found.p,
        found.estimate, found.low, found.high, "log odds ratio",
        found.why_not or "proportional odds, standard errors clustered by person",
    )  # fmt: skip


def all_tests(question: Question, alpha: float, rng: np.random.Generator) -> list[RatingTest]:
    """Every test of a question, in the order in which they are read."""
    tests: list[RatingTest] = []
    groups = [int(question.of_order(name).sum()) for name in question.order_names]
    ordered = len(groups) == 2 and min(groups) >= 2
    if ordered:
        tests += order_tests(question, rng)
    grouped = all(test.p is None or test.p >= alpha for test in tests)
    tests += method_tests(question, grouped, rng)
    if ordered:
        tests += analyses_of_variance(question)
    return [*tests, ordinal_test(question)]


def comparison_test(name: str, ratings: Array, rng: np.random.Generator) -> RatingTest:
    """Signed-rank of comparison ratings about the midpoint of their scale."""
    difference = ratings - COMPARISON_MIDPOINT
    low, high = _resampled_signed(difference, rng)
    test = _ranked(
        name, "signed-rank, midpoint", ("comparison",), signed_rank(difference), low, high
    )
    spread = float(ratings.std(ddof=1)) if len(ratings) > 1 else None
    test.more.update({"mean": float(ratings.mean()), "sd": spread, "people": len(ratings)})
    return test
