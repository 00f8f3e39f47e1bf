"""What is asked of a benchmark's row is the same on a machine half as fast."""

import pytest

from tests.benchmarks.__main__ import table
from tests.benchmarks.rows import row


@pytest.mark.parametrize(("value", "rival", "met"), [(2.0, 9.0, True), (4.0, 9.0, False)])
def test_a_ratio_is_met_or_not_whatever_the_machine(value: float, rival: float, met: bool) -> None:
    for slower in (1.0, 2.0, 10.0):
        found = row("work", slower * value, "ms", "rival", slower * rival, faster=3.0)
        assert found["met"] is met
        assert found["ratio"] == pytest.approx(rival / value)
        assert found["target"] == "3 ×"


def test_seconds_are_asked_only_where_they_are_felt() -> None:
    found = row("report", 19.0, "s", felt=20.0)
    assert (found["met"], found["target"]) == (True, "20 s felt")
    assert row("report", 21.0, "s", felt=20.0)["met"] is False
    told = row("told", 5.0, "s")
    assert (told["met"], told["target"], told["ratio"]) == (None, None, None)
    assert row("no rival here", 5.0, "s", "rival", None, faster=2.0)["met"] is None


def test_the_table_says_what_is_asked() -> None:
    lines = table([row("work", 4.0, "ms", "rival", 8.0, faster=3.0)]).splitlines()
    assert lines[0].split()[-2:] == ["target", "met"]
    assert lines[1].endswith("3 ×     NO")
