"""The four functions, forward and inverse, against their printed formulas."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analysis.errors import InputError
from analysis.psychometric import FUNCTIONS, level_at, location_for, proportion

LEVELS = np.array([0.5, 1.0, 2.0, 4.0])


def formula(name: str, x: np.ndarray, location: float, slope: float) -> np.ndarray:
    from scipy.stats import norm

    return {
        "logistic": lambda: 1 / (1 + np.exp(-slope * (x - location))),
        "cumulative-normal": lambda: norm.cdf(slope * (x - location)),
        "weibull": lambda: 1 - np.exp(-((x / location) ** slope)),
        "gumbel": lambda: 1 - np.exp(-(10.0 ** (slope * (x - location)))),
    }[name]()


@pytest.mark.parametrize("name", FUNCTIONS)
def test_proportion_is_the_printed_formula(name: str) -> None:
    found = proportion(name, LEVELS, 1.5, 1.3, 0.5, 0.02)
    np.testing.assert_allclose(found, 0.5 + 0.48 * formula(name, LEVELS, 1.5, 1.3), rtol=1e-12)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_parts_are_the_curve_its_complement_and_its_derivative(name: str) -> None:
    function, eta, h = FUNCTIONS[name], np.linspace(-4, 3, 29), 1e-6
    slope = (function.cdf(eta + h) - function.cdf(eta - h)) / (2 * h)
    for found, expected in zip(
        function.parts(eta), (function.cdf(eta), 1 - function.cdf(eta), slope), strict=True
    ):
        np.testing.assert_allclose(found, expected, atol=1e-8)
    np.testing.assert_allclose(function.survival(eta), 1 - function.cdf(eta), atol=1e-12)


@given(
    name=st.sampled_from(sorted(FUNCTIONS)),
    level=st.floats(0.1, 50),
    at=st.floats(0.52, 0.95),
    slope=st.floats(0.05, 5),
    lapse=st.floats(0, 0.04),
)
def test_inverses(name: str, level: float, at: float, slope: float, lapse: float) -> None:
    location = location_for(name, level, at, slope, 0.5, lapse)
    assert np.isclose(proportion(name, level, location, slope, 0.5, lapse), at)
    assert np.isclose(level_at(name, at, location, slope, 0.5, lapse), level)


def test_a_proportion_beyond_the_function_has_no_level() -> None:
    assert np.isnan(level_at("logistic", [0.5, 0.99], 1, 1, 0.5, 0.02)).all()


def test_weibull_at_level_zero_is_the_guess_rate() -> None:
    assert proportion("weibull", 0.0, 2.0, 3.0) == 0.5


def test_an_unknown_function_is_refused_by_name() -> None:
    with pytest.raises(InputError, match=r"expected one of logistic, .* found 'probit'"):
        proportion("probit", 1, 1, 1)
