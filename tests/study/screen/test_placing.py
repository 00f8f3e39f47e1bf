"""Where clips lie on a screen: as large as the layout allows, whole pixels, degrees of angle."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study.screen.placing import shown_sizes, side_by_side, visual_angle

FULL_HD = (1920, 1080)


def test_a_picture_is_shown_pixel_for_pixel_where_there_is_room() -> None:
    found = side_by_side(FULL_HD, (1280, 720), 1, 0.95)
    assert (found.size, found.scale) == ((1280, 720), 1.0)
    assert found.centres == ((0.0, 0.0),)


def test_it_fills_the_height_or_the_width_where_there_is_less_room() -> None:
    assert side_by_side((1280, 720), (1280, 720), 1, 0.95).size == (1216, 684)
    assert side_by_side((1024, 768), (1280, 720), 1, 0.95).size[0] == round(0.95 * 1024)


def test_it_is_larger_only_when_asked_for() -> None:
    found = side_by_side(FULL_HD, (640, 480), 1, 0.95, enlarge=True)
    assert found.size == (1368, 1026)
    assert found.scale == pytest.approx(2.1375)


def test_two_share_the_width() -> None:
    found = side_by_side(FULL_HD, (960, 720), 2, 0.95)
    assert 0.48 * 1920 < found.size[0] <= 960
    assert abs(found.centres[0][0] + found.centres[1][0]) <= 1


@given(
    st.integers(200, 4000), st.integers(200, 3000), st.integers(20, 2000), st.integers(20, 2000),
    st.integers(1, 4), st.floats(0.2, 1), st.booleans(),
)  # fmt: skip
def test_clips_lie_apart_in_the_window_with_edges_between_pixels(
    width: int, height: int, wide: int, tall: int, count: int, share: float, enlarge: bool
) -> None:
    found = side_by_side((width, height), (wide, tall), count, share, enlarge)
    assert enlarge or found.scale <= 1
    left = np.array([x - found.size[0] / 2 + width / 2 for x, _ in found.centres])
    np.testing.assert_allclose(left, np.round(left), atol=1e-9)
    assert left[0] >= -1
    assert left[-1] + found.size[0] <= width + count + 1
    assert np.all(np.diff(left) >= found.size[0])
    bottom = found.centres[0][1] - found.size[1] / 2 + height / 2
    assert bottom == pytest.approx(round(bottom), abs=1e-9)


def test_degrees_are_those_of_the_screen_and_the_distance() -> None:
    assert visual_angle(100, 0.01, 57.2957795) == pytest.approx(1.0, rel=1e-4)
    screen = SimpleNamespace(width=1920, height=1080)
    found = shown_sizes(side_by_side(FULL_HD, (1280, 720), 1, 0.95), screen, 53.0, 57.0)
    assert found["degrees"] == [pytest.approx(34.45, abs=0.05), pytest.approx(19.78, abs=0.05)]
    assert found["screen_width_from"] == "protocol"
    unknown = shown_sizes(side_by_side(FULL_HD, (9, 9), 1, 0.95), screen, None, 57.0)
    assert (unknown["degrees"], unknown["screen_width_from"]) == (None, None)
