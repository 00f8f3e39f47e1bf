"""Rank tests against published cases and against SciPy's permutations."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from analysis.ranks import biserial_signed, biserial_sum, rank_sum, signed_rank

small = st.lists(st.integers(-3, 3), min_size=1, max_size=9)


def test_depression_scale_of_r() -> None:
    """The paired example of R's help on wilcox.test (Hollander and Wolfe 1973, p. 29)."""
    first = [1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30]
    second = [0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29]
    found = signed_rank(np.subtract(first, second))
    assert (found.statistic, found.exact, found.ties) == (40, True, False)
    assert found.p == pytest.approx(0.0390625, abs=1e-12)
    assert found.effect_size == pytest.approx((40 - 5) / 45)


def test_permeability_constants_of_r() -> None:
    """The two-sample example of the same page (Hollander and Wolfe 1973, p. 69): W = 35, and a
    one-sided p of .1272."""
    term = [0.80, 0.83, 1.89, 1.04, 1.45, 1.38, 1.91, 1.64, 0.73, 1.46]
    weeks = [1.15, 0.88, 0.90, 0.74, 1.21]
    found = rank_sum(term, weeks)
    assert found.statistic == 35
    assert found.p / 2 == pytest.approx(0.1272, abs=5e-5)


@settings(max_examples=30)
@given(differences=small.filter(any))
def test_signed_rank_is_exact_with_ties(differences: list[int]) -> None:
    kept = np.array([d for d in differences if d])
    if len(kept) < 2:
        return
    expected = stats.wilcoxon(kept, method=stats.PermutationMethod(n_resamples=np.inf)).pvalue
    assert signed_rank(differences).p == pytest.approx(expected)


@settings(max_examples=30)
@given(
    first=st.lists(st.integers(1, 5), min_size=2, max_size=6),
    second=st.lists(st.integers(1, 5), min_size=2, max_size=6),
)
def test_rank_sum_is_exact_with_ties(first: list[int], second: list[int]) -> None:
    def statistic(x: np.ndarray, y: np.ndarray) -> float:
        return stats.rankdata(np.concatenate([x, y]))[: len(x)].sum()

    expected = stats.permutation_test((first, second), statistic, n_resamples=np.inf).pvalue
    assert rank_sum(first, second).p == pytest.approx(expected)


def test_large_samples_are_normal_with_corrected_ties() -> None:
    rng = np.random.default_rng(0)
    x, y = rng.integers(1, 6, 60), rng.integers(1, 6, 50)
    found = rank_sum(x, y)
    expected = stats.mannwhitneyu(x, y, use_continuity=False, method="asymptotic")
    assert not found.exact
    assert found.p == pytest.approx(expected.pvalue)
    d = rng.integers(-3, 4, 90)
    expected = stats.wilcoxon(d, correction=False, method="asymptotic")
    assert signed_rank(d).p == pytest.approx(expected.pvalue)


def test_the_treatment_is_stated() -> None:
    assert signed_rank([1, 1, 0, -2]).how == (
        "exact, mean ranks for ties, 1 zero difference left out"
    )


def test_where_nothing_differs_there_is_no_test() -> None:
    none, empty = signed_rank([0, 0]), rank_sum([], [1])
    assert (none.statistic, none.p, none.effect_size) == (None, None, None)
    assert none.how == "no test: no difference but 0 in 2"
    assert (empty.p, empty.how) == (None, "no test: a group without ratings")


@given(
    tenths=st.lists(st.integers(-9, 9), min_size=2, max_size=12).filter(any),
    base=st.sampled_from([0.1, 1.1, 3.3]),
)
def test_differences_that_are_equal_but_for_rounding_are_ties(
    tenths: list[int], base: float
) -> None:
    """Differences of means a fifth apart, worked out in floating point from different means."""
    rough = [(base * n + d / 5) - base * n for n, d in enumerate(tenths)]
    whole, found = signed_rank(tenths), signed_rank(rough)
    assert (found.statistic, found.n, found.ties) == (whole.statistic, whole.n, whole.ties)
    assert found.p == pytest.approx(whole.p)
    batched = biserial_signed(np.array([rough]))[0]
    assert batched == pytest.approx(whole.effect_size)


@given(
    first=st.lists(st.integers(1, 9), min_size=1, max_size=6),
    second=st.lists(st.integers(1, 9), min_size=1, max_size=6),
)
def test_means_that_are_equal_but_for_rounding_share_a_rank(
    first: list[int], second: list[int]
) -> None:
    rough = [np.mean([n / 3, 0.1, 0.2, 0.3]) * 4 - 0.6 for n in first], [n / 3 for n in second]
    whole, found = rank_sum(first, second), rank_sum(*rough)
    assert (found.statistic, found.ties) == (whole.statistic, whole.ties)
    assert biserial_sum(*(np.array([r]) for r in rough))[0] == pytest.approx(whole.effect_size)


@given(small.filter(any))
def test_the_batched_correlation_is_the_single_one(differences: list[int]) -> None:
    batched = biserial_signed(np.array([differences], float))[0]
    assert batched == pytest.approx(signed_rank(differences).effect_size)


def test_the_batched_rank_sum_correlation_is_the_single_one() -> None:
    x, y = np.array([[1.0, 2, 5]]), np.array([[2.0, 2, 1, 0]])
    assert biserial_sum(x, y)[0] == pytest.approx(rank_sum(x[0], y[0]).effect_size)
