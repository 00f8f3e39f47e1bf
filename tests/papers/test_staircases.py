"""Staircases against published sequences, targets and chains."""

import numpy as np
import pytest
from scipy.stats import norm

from study.trials.chain import stationary
from study.trials.quest import Grid, best_place
from study.trials.rules import RULES, rule_levitt, target_weighted
from study.trials.staircase import Stop, answer, start_track

NEVER = Stop((("trials", 10**9),), most=10**9)


@pytest.mark.parametrize(
    ("n_down", "answers", "reversals"),
    [
        (1, "CCIIIICCIIICCCCCIIICCIII", [3, 7, 9, 12, 17, 20, 22]),
        (2, "CCCCICIICICCCCCIIICCCCCC", [5, 12, 16, 20]),
    ],
)
def test_levitt_1971_reverses_where_his_figures_do(
    n_down: int, answers: str, reversals: list[int]
) -> None:
    """Levitt 1971, figures 4 and 5: one up, and one or two down."""
    track = start_track("t", range(1, 60), rule_levitt(n_down, 1), NEVER, 30)
    found = []
    for trial, letter in enumerate(answers, start=1):
        before = len(track.reversals)
        track = answer(track, letter == "C")
        found += [trial] * (len(track.reversals) - before)
    assert found == reversals


@pytest.mark.parametrize(
    ("n_down", "ratio", "percent"),
    [(1, 0.2845, 77.85), (2, 0.5488, 80.35), (3, 0.7393, 83.15), (4, 0.8415, 85.84)],
)
def test_garcia_perez_1998_targets_by_ratio_of_steps(
    n_down: int, ratio: float, percent: float
) -> None:
    """García-Pérez 1998, table 1: steps down over up for 1 to 4 right answers down."""
    assert 100 * target_weighted(ratio, 1.0, n_down) == pytest.approx(percent, abs=0.01)


@pytest.mark.parametrize(("step", "turns"), [(0.25, -0.2727), (1.0, -0.4666)])
def test_mean_reversal_of_two_down_one_up_on_a_cumulative_normal(step: float, turns: float) -> None:
    """Guess rate one half: coarse steps turn below the proportion that the rule aims at."""
    count = round(12 / step)
    levels = np.arange(-count, count + 1) * step
    found = stationary(rule_levitt(2, 1), levels, 0.5 + 0.5 * norm.cdf(levels))
    assert found.mean_reversal == pytest.approx(turns, abs=1e-4)


WATSON = {
    "threshold": (
        (3.5,),
        "CCCCIICCCCCCCCICCICCICCCCCCCCCCC",
        [-18, -22, -25, -28, -30, -22, -13, -15, -16, -18, -19, -20, -21, -22, -23, -19, -20, -20,
         -18, -18, -19, -17, -17, -18, -18, -18, -19, -19, -19, -19, -19, -19],
    ),
    "threshold and slope": (
        (2.0, 3.0, 4.0, 5.0),
        "CICCCCCCCCCCCICCICCCICCCCICCCCCCCCCCCICCIICCCCICICCCICCCCCCCCCCC",
        [-18, -22, -12, -13, -15, -16, -17, -18, -19, -21, -24, -25, -26, -27, -21, -22, -23, -20,
         -20, -20, -21, -19, -19, -20, -20, -20, -19, -19, -19, -19, -19, -20, -20, -20, -20, -20,
         -21, -21, -20, -20, -20, -19, -18, -18, -19, -19, -19, -18, -18, -17, -18, -18, -18, -17,
         -17, -17, -17, -17, -17, -17, -18, -18, -18, -18],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", WATSON)
def test_watson_2017_asks_the_published_contrasts(name: str) -> None:
    """Watson 2017, "Implementation" and example 1: contrasts in dB, Weibull, lapse .02."""
    slopes, letters, contrasts = WATSON[name]
    decibels = tuple(map(float, range(-40, 1)))
    grid = Grid(decibels, decibels, slopes, 0.5, 0.02, "weibull", "dB")
    answers: tuple[tuple[int, bool], ...] = ()
    for letter, contrast in zip(letters, contrasts, strict=True):
        place = best_place(grid, answers)
        assert decibels[place] == contrast
        answers = (*answers, (place, letter == "C"))


def test_quest_plus_finds_the_threshold_of_a_simulated_person() -> None:
    """An observer of the rule's own kind, 60 answers: the posterior's level lies at theirs."""
    generator = np.random.default_rng(8)
    levels = tuple(range(1, 16))
    asked = []
    for threshold in (3.0, 8.0):
        track = start_track("t", levels, RULES["questplus"](), NEVER)
        for _ in range(60):
            x = track.level / threshold
            right = 0.5 + 0.48 * (1 - np.exp(-(x**3)))
            track = answer(track, bool(generator.random() < right))
        asked.append(np.mean([level for level, _ in track.answers[20:]]))
        replayed = start_track("t", levels, RULES["questplus"](), NEVER)
        for _, correct in track.answers:
            replayed = answer(replayed, correct)
        assert (replayed.answers, replayed.state) == (track.answers, track.state)
    assert asked[0] == pytest.approx(3.0, abs=1.2)
    assert asked[1] == pytest.approx(8.0, abs=2.5)
