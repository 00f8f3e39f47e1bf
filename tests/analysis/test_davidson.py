"""Strengths with ties against closed forms and a known truth."""

import numpy as np
import pandas as pd
import pytest

from analysis.bradley_terry import bradley_terry
from analysis.davidson import davidson, tied_scale
from analysis.preferences import contests


def test_two_methods_have_a_closed_form() -> None:
    """The odds are those of the wins; ν is the ties over the geometric mean of the wins."""
    strength, tie = davidson(np.array([[0, 40], [10, 0]]), np.array([[0, 20], [20, 0]]))
    assert strength[0] - strength[1] == pytest.approx(np.log(4))
    assert np.exp(tie) == pytest.approx(20 / np.sqrt(400))


def test_few_ties_leave_the_scale_of_bradley_and_terry() -> None:
    wins = np.array([[0, 70, 80], [30, 0, 65], [20, 35, 0]]) * 1000
    ties = np.ones((3, 3)) - np.eye(3)
    assert davidson(wins, ties)[0] == pytest.approx(bradley_terry(wins), abs=1e-3)


def test_where_there_is_no_bound_or_no_tie() -> None:
    assert np.isnan(davidson(np.array([[0, 5], [0, 0]]), np.zeros((2, 2)))[0]).all()
    assert np.isnan(davidson(np.array([[0, 5], [3, 0]]), np.zeros((2, 2)))[1])


def simulated(rng: np.random.Generator) -> pd.DataFrame:
    truth, tie = {"a": 0.8, "b": 0.1, "c": -0.9}, -0.4
    rows = []
    for person in range(40):
        for _ in range(12):
            first, second = map(str, rng.permutation(list(truth))[:2])
            odds = np.exp([truth[first], truth[second], tie + (truth[first] + truth[second]) / 2])
            answer = rng.choice(3, p=odds / odds.sum())
            chosen = (first, second, None)[answer]
            rows.append((f"p{person}", first, second, chosen, answer == 2))
    columns = ["participant", "first_method", "second_method", "chosen_method", "tie"]
    return pd.DataFrame(rows, columns=columns)


def test_the_truth_is_recovered() -> None:
    rng = np.random.default_rng(1)
    trials = simulated(rng)
    found = tied_scale(trials, ("a", "b", "c"), rng)
    assert found is not None
    assert [entry.method for entry in found.strengths] == ["a", "b", "c"]
    for entry, true in zip(found.strengths, (0.8, 0.1, -0.9), strict=True):
        assert entry.low is not None
        assert entry.high is not None
        assert entry.low < true < entry.high
    assert found.tie == pytest.approx(-0.4, abs=0.25)
    assert found.ties == int(trials["tie"].sum())


def test_ties_are_counted_beside_the_choices() -> None:
    trials = simulated(np.random.default_rng(2))
    found = contests(trials, ("a", "b", "c"))
    assert sum(len(contest.ties) for contest in found) == int(trials["tie"].sum())
    assert sum(contest.count.n for contest in found) == int((~trials["tie"]).sum())
