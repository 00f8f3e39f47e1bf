"""What a screen's rate does to clips of 30 frames a second, in words and on record."""

import pytest

from stimuli.errors import InputError
from study.screen.refresh import Refresh, notes_on


@pytest.mark.parametrize("rate", [30.0, 59.98, 60.0, 60.02, 90.0, 120.0, 239.9])
def test_rates_that_show_frames_evenly_need_no_word(rate: float) -> None:
    assert notes_on(Refresh(round(rate), rate), 30.0, False) == []


@pytest.mark.parametrize(
    ("rate", "said"),
    [
        (59.4, "for 1 or 2 refreshes in turn"),
        (75.0, "for 2 or 3 refreshes in turn (2.5 on average)"),
        (144.0, "for 4 or 5 refreshes in turn (4.8 on average)"),
        (165.0, "for 5 or 6 refreshes in turn (5.5 on average)"),
    ],
)
def test_uneven_rates_are_named_with_what_will_happen(rate: float, said: str) -> None:
    (note,) = notes_on(Refresh(rate, rate), 30.0, False)
    assert said in note
    assert "such as 60 or 120 Hz" in note


@pytest.mark.parametrize(("rate", "lost"), [(24.0, "20 %"), (25.0, "17 %")])
def test_a_screen_slower_than_the_clips_is_refused_unless_allowed(rate: float, lost: str) -> None:
    with pytest.raises(InputError, match=f"never show {lost}"):
        notes_on(Refresh(rate, rate), 30.0, False)
    (note,) = notes_on(Refresh(rate, rate), 30.0, True)
    assert "the protocol allows it" in note


def test_where_the_system_and_the_measure_disagree_the_measure_is_used_and_said() -> None:
    refresh = Refresh(60.0, 120.2)
    assert refresh.rate == 120.2
    (note,) = notes_on(refresh, 30.0, False)
    assert "states 60 Hz, 120.20 Hz were measured" in note
    facts = refresh.facts()
    assert (facts["refresh_rate_stated"], facts["refresh_rate_measured"]) == (60.0, 120.2)


def test_without_a_vertical_blank_the_clock_paces() -> None:
    refresh = Refresh(None, None)
    assert refresh.facts() == {
        "vsync": False, "refresh_rate": None, "paced_at": 60.0,
        "refresh_rate_stated": None, "refresh_rate_measured": None,
    }  # fmt: skip
    assert notes_on(refresh, 30.0, False) == []


def test_at_another_pace_frames_are_left_out_anyway() -> None:
    assert notes_on(Refresh(24.0, 24.0), 30.0, False, pace=20.0) == []
