"""The statistics printed in Wang 2005, from its own counts."""

from pathlib import Path

import pytest

from analysis.preferences import chi_square, preference
from analysis.report import write_report
from tests.analysis import records

# Table V.2: percentage and χ² of each study, with the counts that give them.
TABLE_V_2 = [
    ("geodesic", "fixed", 270, 35, 8, 96.4, 241.43),
    ("velocity", "fixed", 184, 35, 8, 65.7, 27.66),
    ("geodesic", "timewarp", 156, 35, 8, 55.7, 3.66),
    ("geodesic", "velocity", 27, 12, 3, 75.0, 9.00),
    ("velocity", "geodesic", 32, 12, 3, 88.9, 21.78),
]


@pytest.mark.parametrize(("a", "b", "chosen", "people", "motions", "percent", "chi2"), TABLE_V_2)
def test_table_v_2(
    a: str, b: str, chosen: int, people: int, motions: int, percent: float, chi2: float,
    tmp_path: Path,
) -> None:  # fmt: skip
    protocol = records.preference_protocol(methods=[a, b])
    sessions = records.counted_preferences(chosen, people, motions, a, b)
    data = records.write_dataset(tmp_path, protocol, sessions)
    found = write_report([data]).document["studies"][0]["comparisons"][0]
    assert found["a"] == a
    assert found["percent"] == pytest.approx(percent, abs=0.05)
    assert found["chi2"] == pytest.approx(chi2, abs=0.005)


def test_the_conclusions_of_table_v_2_hold_at_its_alpha() -> None:
    significant = [
        preference(chosen, people * motions).p < 0.01  # type: ignore[operator]
        for _, _, chosen, people, motions, _, _ in TABLE_V_2
    ]
    assert significant == [True, True, False, True, True]


def test_the_critical_value_of_v_2_2() -> None:
    """The critical χ²(1) at α = .01 is 6.64 there: 162 of 280 reach it, 161 do not."""
    assert chi_square(161, 280) < 6.64 < chi_square(162, 280)
