"""Fits against printed ones beyond the demos: the beetles of Bliss, with guess rate 0."""

import numpy as np
import pytest

from analysis.psychometric import counts, setting, summarise

# Beetles killed by carbon disulphide (Bliss 1935), as Dobson (2002, table 7.2) prints them:
# log10 dose, killed, exposed. Her table 7.4 and section 7.3.1 print the fits.
DOSE = [1.6907, 1.7242, 1.7552, 1.7842, 1.8113, 1.8369, 1.8610, 1.8839]
KILLED = [6, 13, 18, 28, 52, 53, 61, 60]
EXPOSED = [59, 60, 62, 56, 63, 59, 62, 60]


@pytest.mark.parametrize(
    ("name", "intercept", "slope", "deviance", "unit"),
    [
        ("logistic", -60.72, 34.27, 11.23, 1.0),
        ("cumulative-normal", -34.94, 19.73, 10.12, 1.0),
        ("gumbel", -39.57, 22.04, 3.45, np.log(10)),
    ],
)
def test_beetles(name: str, intercept: float, slope: float, deviance: float, unit: float) -> None:
    found = summarise(counts(DOSE, KILLED, EXPOSED), setting(name, 0.0, 0.0), (0.5,), samples=0)
    assert found.slope * unit == pytest.approx(slope, abs=0.006)
    assert -found.location * found.slope * unit == pytest.approx(intercept, abs=0.006)
    assert found.deviance == pytest.approx(deviance, abs=0.006)


def test_weibull_on_dose_is_gumbel_on_its_logarithm() -> None:
    dose = counts(10 ** np.array(DOSE), KILLED, EXPOSED)
    log_dose = counts(DOSE, KILLED, EXPOSED)
    weibull = summarise(dose, setting("weibull", 0.0, 0.0), (0.5,), samples=0)
    gumbel = summarise(log_dose, setting("gumbel", 0.0, 0.0), (0.5,), samples=0)
    assert weibull.deviance == pytest.approx(gumbel.deviance, abs=1e-6)
    assert weibull.slope == pytest.approx(gumbel.slope, rel=1e-4)
    for end in ("value", "low", "high"):
        one, other = getattr(weibull.thresholds[0], end), getattr(gumbel.thresholds[0], end)
        assert np.log10(one) == pytest.approx(other, abs=1e-4)
