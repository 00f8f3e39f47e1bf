"""Analyses of variance against statsmodels and against t tests."""

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from analysis.anova import eta_interval, independent, split_plot


def ratings() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(1)
    a = rng.integers(1, 6, 26).astype(float)
    b = np.clip(a + rng.integers(-1, 3, 26), 1, 5).astype(float)
    return a, b, np.where(np.arange(26) < 12, -1.0, 1.0)


def test_independent_is_the_type_three_table_of_statsmodels() -> None:
    import statsmodels.api as sm
    from statsmodels.formula.api import ols

    a, b, order = ratings()
    table = pd.DataFrame(
        {"y": np.r_[a, b], "m": np.repeat([-1.0, 1.0], 26), "o": np.r_[order, order]}
    )
    expected = sm.stats.anova_lm(ols("y ~ m * o", table).fit(), typ=3).loc[["m", "o", "m:o"]]
    found = independent(table["y"].to_numpy(), table["m"].to_numpy(), table["o"].to_numpy())
    assert [e.statistic for e in found] == pytest.approx(list(expected["F"]))
    assert [e.p for e in found] == pytest.approx(list(expected["PR(>F)"]))
    assert found[0].df == (1, 48)


def test_mixed_is_made_of_t_tests() -> None:
    a, b, order = ratings()
    method, between, both = split_plot(a, b, order)
    first, second = order < 0, order > 0
    mean, difference = (a + b) / 2, b - a
    assert between.statistic == pytest.approx(
        stats.ttest_ind(mean[first], mean[second]).statistic ** 2
    )
    assert both.statistic == pytest.approx(
        stats.ttest_ind(difference[first], difference[second]).statistic ** 2
    )
    assert method.df == between.df == (1, 24)


def test_mixed_of_a_balanced_table_is_the_split_plot_of_statsmodels() -> None:
    from statsmodels.stats.anova import AnovaRM

    a, b, _ = ratings()
    order = np.repeat([-1.0, 1.0], 13)
    method, *_ = split_plot(a, b, np.concatenate([order]))
    table = pd.DataFrame(
        {"y": np.r_[a, b], "m": np.repeat(["a", "b"], 26), "s": np.tile(np.arange(26), 2)}
    )
    repeated = AnovaRM(table, "y", "s", within=["m"]).fit().anova_table["F Value"].iloc[0]
    # The same sum of squares; only the interaction leaves the error term.
    assert method.statistic == pytest.approx(repeated, rel=0.15)


def test_interval_of_eta_by_the_noncentral_f() -> None:
    """Its ends put the observed F at the 97.5 and 2.5 % points of the noncentral F."""
    low, high = eta_interval(11.0, 1, 48)
    for end, tail in ((low, 0.975), (high, 0.025)):
        noncentrality = end * 50 / (1 - end)
        assert stats.ncf.cdf(11.0, 1, 48, noncentrality) == pytest.approx(tail, abs=1e-6)
    assert eta_interval(0.5, 1, 48)[0] == 0
