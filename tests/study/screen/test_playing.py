"""Frames over refreshes, on a screen of which the test says what its flips take."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stimuli.errors import UnwritableError
from study.screen.fliplog import FLIP_COLUMNS, log_flips
from study.screen.playing import Flip, play
from study.screen.schedule import last_refresh, schedule


class Screen:
    """A screen whose flips wait for its refreshes, and take as many of them as is said."""

    def __init__(self, rate: float, slow: dict[int, int], has_time: bool = True) -> None:
        self.rate, self._slow, self._has_time = rate, slow, has_time
        self._refresh, self._flips, self._clock = 0, 0, 0.0

    def now(self) -> float:
        return self._clock

    def idle(self) -> bool:
        return self._has_time

    def sleep_until(self, due: float) -> None:
        self._clock = max(self._clock, due - 0.5 / self.rate)

    def flip(self) -> float:
        at = int(np.floor(self._clock * self.rate + 1e-6)) + 1 + self._slow.get(self._flips, 0)
        self._flips += 1
        self._clock = at / self.rate
        return self._clock


def shown(screen: Screen, frames: int = 60, pace: float = 1.0) -> list[Flip]:
    dues = schedule(frames, 30.0, screen.rate, pace)
    drawn: list[int] = []
    flips = play(
        dues, last_refresh(frames, 30.0, screen.rate, pace), screen, drawn.append, lambda: None
    )
    assert drawn == list(range(len(dues)))
    assert [flip.frame for flip in flips if flip.due is not None] == [due.frame for due in dues]
    return flips


@pytest.mark.parametrize("rate", [30.0, 59.94, 60.0, 75.0, 120.0, 144.0])
def test_every_refresh_is_flipped_and_every_frame_shown_when_it_is_due(rate: float) -> None:
    flips = shown(Screen(rate, {}))
    assert len(flips) == last_refresh(60, 30.0, rate)
    at = (np.array([flip.at for flip in flips]) - flips[0].at) * rate
    assert at == pytest.approx(np.arange(len(flips)), abs=1e-6)
    for flip, refresh in zip(flips, at, strict=True):
        assert flip.due is None or refresh == pytest.approx(flip.due)


@given(st.dictionaries(st.integers(0, 119), st.integers(1, 12), max_size=6), st.booleans())
def test_a_late_frame_is_shown_late_and_none_is_left_out(slow: dict[int, int], idle: bool) -> None:
    flips = shown(Screen(60.0, slow, idle))
    times = [flip.at for flip in flips]
    assert (np.diff(times) > 0.9 / 60).all()  # each is there for a refresh at least
    for flip in flips:
        assert flip.due is None or flip.at - times[0] >= flip.due / 60 - 1e-9


def test_where_no_refresh_waits_and_flips_are_slow_only_frames_are_flipped() -> None:
    assert len(shown(Screen(60.0, {}, has_time=False))) == 60


def test_at_a_higher_pace_frames_are_sampled() -> None:
    flips = shown(Screen(60.0, {}), frames=180, pace=20.0)
    assert len(flips) == 19  # the last of the frames once more than its time has refreshes
    assert flips[-1].frame == 179


def test_the_log_goes_on_after_a_line_that_was_torn(tmp_path: Path) -> None:
    path = tmp_path / "flips.tsv"
    flips = [Flip(0, 0, 5.0), Flip(0, None, 5.0167), Flip(1, 2, 5.0333)]
    log_flips(path, "trial 1", 1, flips, 60.0, 1e9)
    path.write_bytes(path.read_bytes()[:-5])
    log_flips(path, "trial 1", 2, flips[:1], 60.0, 1e9)
    assert path.read_text().splitlines() == [
        "\t".join(FLIP_COLUMNS),
        "trial 1\t1\t0\t0.0000\t0.0000\t1000000005.0000",
        "trial 1\t1\t0\tn/a\t0.0167\tn/a",
        "trial 1\t1\t1\t0.0333\t0.0333",
        "trial 1\t2\t0\t0.0000\t0.0000\t1000000005.0000",
    ]
    with pytest.raises(UnwritableError, match="the flips of trial 2 could not be written"):
        log_flips(tmp_path, "trial 2", 1, flips, 60.0, 0.0)
