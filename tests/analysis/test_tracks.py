"""Estimates of a staircase from its levels alone."""

import numpy as np
import pytest

from analysis.tracks import reversal_mean, reversals, stop_level


@pytest.mark.parametrize(
    ("levels", "turns"),
    [
        ([5, 4, 3, 3, 4, 5, 4], [3, 5]),
        ([3, 3, 3], []),
        ([3, 2, 2, 1], []),
        ([2, 3, 3, 2, 3], [2, 3]),
    ],
)
def test_reversals(levels: list[int], turns: list[int]) -> None:
    assert list(reversals(np.array(levels, float))) == turns


def test_first_reversals_are_left_out_where_there_are_enough() -> None:
    assert reversal_mean(np.array([9, 1, 5, 3, 5, 3.0])) == 4.0
    assert reversal_mean(np.array([5, 3, 5.0])) == 3.0
    assert reversal_mean(np.array([5, 5.0])) is None


def test_stop_level_is_the_first_to_be_visited_most() -> None:
    assert stop_level(np.array([3, 2, 2, 3, 2.0])) == 2
    assert stop_level(np.array([3, 2, 2, 3.0])) == 2
    assert stop_level(np.array([1, 1, 4, 4, 4, 1.0])) == 4
    assert stop_level(np.array([2, 1, 1, 2.0])) == 1
    assert stop_level(np.array([])) is None
