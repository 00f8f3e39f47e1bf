"""Preferences against closed forms and against what SciPy computes otherwise."""

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analysis.preferences import contests, critical, preference


@given(n=st.integers(1, 400), share=st.floats(0, 1))
def test_the_interval_holds_the_percentage_and_p_is_symmetric(n: int, share: float) -> None:
    k = round(share * n)
    one, other = preference(k, n), preference(n - k, n)
    assert one.low is not None
    assert one.high is not None
    assert one.percent is not None
    assert 0 <= one.low <= one.percent + 1e-9
    assert one.percent - 1e-9 <= one.high <= 100
    assert one.chi2 == pytest.approx(other.chi2)
    assert one.binomial_p == pytest.approx(other.binomial_p)


def test_nobody_answered() -> None:
    assert preference(0, 0).p is None


def test_wilson_interval_of_a_textbook_case() -> None:
    """81 of 263 gives .2553 to .3662 (Newcombe 1998, table I, method 3)."""
    found = preference(81, 263)
    assert found.low == pytest.approx(25.53, abs=0.005)
    assert found.high == pytest.approx(36.62, abs=0.005)


def test_contests_name_the_protocols_first_method_a() -> None:
    rows = [
        ("p1", "m1", "locomotion", "fixed", "geodesic", "geodesic"),
        ("p1", "m2", "activity", "geodesic", "fixed", "fixed"),
        ("p2", "m1", "locomotion", "geodesic", "fixed", None),
    ]
    names = ["participant", "motion", "category", "first_method", "second_method", "chosen_method"]
    table = pd.DataFrame(rows, columns=names)
    found = contests(table, ("geodesic", "fixed"))
    assert [(c.a, c.b, c.category, len(c.choices)) for c in found] == [
        ("geodesic", "fixed", "all", 2),
        ("geodesic", "fixed", "activity", 1),
        ("geodesic", "fixed", "locomotion", 1),
    ]
    assert found[0].count.prefer_a == 1


def test_the_smallest_significant_majority() -> None:
    assert critical(36, 0.05) == 25
    assert critical(4, 0.05) == 5
