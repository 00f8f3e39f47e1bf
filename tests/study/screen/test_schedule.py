"""Which frame is due at which refresh, and which came late."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from study.screen.schedule import last_refresh, late_frames, schedule


def test_each_frame_lasts_two_refreshes_at_sixty_hertz() -> None:
    dues = schedule(180, 30.0, 60.0)
    assert [(d.frame, d.refresh) for d in dues[:4]] == [(0, 0), (1, 2), (2, 4), (3, 6)]
    assert [d.frame for d in dues] == list(range(180))
    assert last_refresh(180, 30.0, 60.0) == 360


@given(
    frames=st.integers(1, 200),
    rate=st.floats(20, 240),
    pace=st.floats(0.1, 30),
)
def test_frames_run_forward_from_first_to_last(frames: int, rate: float, pace: float) -> None:
    dues = schedule(frames, 30.0, rate, pace)
    assert dues[0] == (0, 0)
    assert dues[-1].frame == frames - 1
    assert all(a.frame < b.frame and a.refresh < b.refresh for a, b in itertools.pairwise(dues))
    for due in dues:
        assert due.frame <= due.refresh / rate * 30.0 * pace + 1e-3


@pytest.mark.parametrize(("lag", "late"), [(0.0, 0), (0.016, 0), (0.018, 1), (0.1, 1)])
def test_a_frame_is_late_after_one_refresh(lag: float, late: int) -> None:
    dues = schedule(10, 30.0, 60.0)
    flips = [5.0 + d.refresh / 60.0 for d in dues]
    flips[4] += lag
    assert late_frames(dues, flips, 60.0) == late
