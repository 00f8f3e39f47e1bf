"""Which frame is due at which refresh, and which came late."""

import csv
import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study.screen.schedule import frames_late, last_refresh, late_frames, never_shown, schedule
from tests.conftest import NO_CASES, SHARED


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


@pytest.mark.parametrize(
    ("lag", "late"), [(0.0, 0), (0.008, 0), (0.0085, 1), (0.0166, 1), (0.0168, 1), (0.1, 1)]
)
def test_a_frame_is_late_after_half_a_refresh(lag: float, late: int) -> None:
    dues = schedule(10, 30.0, 60.0)
    flips = [5.0 + d.refresh / 60.0 for d in dues]
    flips[4] += lag
    assert late_frames(dues, flips, 60.0) == late


@pytest.mark.parametrize("rate", [60.0, 120.0])
def test_ten_frames_a_refresh_late_are_ten_whatever_the_jitter(rate: float) -> None:
    """Cases of flips that jitter by .1 ms."""
    path = SHARED.parent / "cases" / "session" / f"flips_{rate:g}hz.csv"
    if not path.is_file():
        pytest.skip(NO_CASES)
    with path.open(newline="") as stream:
        flips = [float(row["flip"]) for row in csv.DictReader(stream)]
    assert late_frames(schedule(180, 30.0, rate), flips, rate) == 10


@given(rate=st.sampled_from([60.0, 100.0, 144.0, 240.0]), seed=st.integers(0, 99))
def test_jitter_decides_nothing(rate: float, seed: int) -> None:
    """Frames on time and one refresh late, each a tenth of a refresh off by chance."""
    generator = np.random.default_rng(seed)
    dues = schedule(60, 30.0, rate)
    slow = set(generator.choice(np.arange(1, 60), 7, replace=False).tolist())
    jitter = generator.uniform(-0.1, 0.1, 60) / rate
    jitter[0] = 0.0
    flips = [3.0 + (due.refresh + (due.frame in slow)) / rate + jitter[due.frame] for due in dues]
    assert set(frames_late(dues, flips, rate)) == slow


@pytest.mark.parametrize(("rate", "lost"), [(24.0, 36), (25.0, 30)])
def test_a_slow_screen_leaves_frames_out(rate: float, lost: int) -> None:
    shown = len(schedule(180, 30.0, rate))
    assert 180 - shown == pytest.approx(lost, abs=1)
    assert 180 * never_shown(30.0, rate) == pytest.approx(lost, abs=1e-9)
