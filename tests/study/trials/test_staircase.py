"""Staircases: the rules by hand, and properties of tracks under any answers."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study.trials.chain import stationary
from study.trials.rules import RULES, rule_levitt, rule_wang, rule_weighted, target_weighted
from study.trials.staircase import Stop, Track, answer, replay_track, start_track

NEVER = Stop((("trials", 10**9),), most=10**9)
ANSWERS = st.lists(st.booleans(), max_size=80)
RULE = st.sampled_from([rule() for name, rule in RULES.items() if name != "questplus"])
LEVELS = st.lists(st.integers(1, 40), min_size=1, max_size=12, unique=True).map(sorted)


def levels_shown(rule_name: str, answers: str, levels: tuple[int, ...] = (1, 2, 3, 4, 5)) -> str:
    """The levels a track shows, start included, for answers written as r and w."""
    track = start_track("t", levels, RULES[rule_name](), NEVER)
    shown = [track.level]
    for letter in answers:
        track = answer(track, letter == "r")
        shown.append(track.level)
    return "".join(map(str, shown))


@pytest.mark.parametrize(
    ("rule", "answers", "shown"),
    [
        ("levitt", "rrrrww", "5544334"[:5] + "45"),
        ("levitt", "rwrwrr", "5555554"),
        ("wang", "rrrrw", "554323"),
        ("wang", "rrrwrr", "5543" + "454"),
        ("wang", "w", "55"),
        ("weighted", "rrw", "5434"),
    ],
)
def test_rules_step_as_written(rule: str, answers: str, shown: str) -> None:
    assert levels_shown(rule, answers) == shown


def test_after_an_error_wang_goes_up_until_two_in_a_row() -> None:
    assert levels_shown("wang", "rrrrrwrwrr") == "55432123454"


def test_levitt_counters_restart_after_each_step() -> None:
    assert levels_shown("levitt", "rrr") == "5544"


@given(RULE, LEVELS, ANSWERS)
def test_a_track_stays_on_its_levels_and_replays_exactly(rule, levels, answers) -> None:
    track = start_track("t", levels, rule, NEVER)
    states = [track]
    for correct in answers:
        track = answer(track, correct)
        states.append(track)
        assert track.level in levels
        assert 0 <= track.position <= len(levels) - 1
    again = replay_track(start_track("t", levels, rule, NEVER), [a for _, a in track.answers])
    assert again == track
    assert len(track.reversals) <= max(len(answers) - 1, 0)


@given(LEVELS, ANSWERS)
def test_no_reversal_without_a_turn(levels, answers) -> None:
    track = start_track("t", levels, rule_levitt(), NEVER)
    places = [len(levels) - 1]
    for correct in answers:
        track = answer(track, correct)
        places.append(levels.index(track.level))
    moves = [b - a for a, b in itertools.pairwise(places) if b != a]
    turns = sum(a * b < 0 for a, b in itertools.pairwise(moves))
    assert len(track.reversals) == turns


def test_the_tenth_answer_at_a_level_ends_the_track() -> None:
    track = start_track("t", (1, 2), rule_levitt(), Stop((("visits", 10),)))
    count = 0
    while track.stopped_by is None:
        track = answer(track, False)
        count += 1
    assert (count, track.stopped_by) == (10, "visits 10")
    assert track.ended_at_edge
    with pytest.raises(ValueError, match="has ended"):
        answer(track, True)


def test_conditions_combine_by_all() -> None:
    stop = Stop((("visits", 3), ("reversals", 1)), all)
    track = start_track("t", (1, 2, 3), rule_levitt(), stop)
    track = replay_track(track, [False] * 6)
    assert track.stopped_by is None
    track = replay_track(track, [True, True, False])
    assert track.stopped_by == "visits 3 and reversals 1"


@pytest.mark.parametrize("levels", [(), (0, 1), (2, 1), (1, 1)])
def test_levels_that_are_no_levels_are_refused(levels) -> None:
    with pytest.raises(ValueError, match="ascending levels"):
        start_track("t", levels, rule_wang(), NEVER)


@pytest.mark.parametrize(("down", "up", "n_down"), [(1, 1, 1), (1, 3, 1), (1, 1, 2), (1, 2, 3)])
def test_weighted_steps_reach_kaernbachs_target(down: int, up: int, n_down: int) -> None:
    levels = np.linspace(-4, 4, 401)
    correct = 1 / (1 + np.exp(-levels))
    long_run = stationary(rule_weighted(down, up, n_down), levels, correct)
    at_mean = np.interp(long_run.mean_level, levels, correct)
    assert at_mean == pytest.approx(target_weighted(down, up, n_down), abs=0.01)


def test_fractional_steps_show_the_nearest_level() -> None:
    track: Track = start_track("t", (1, 2, 3, 4), rule_weighted(0.4, 1.0), NEVER)
    shown = [track.level]
    for _ in range(4):
        track = answer(track, True)
        shown.append(track.level)
    assert shown == [4, 4, 3, 3, 2]


def test_an_exact_chain_needs_whole_steps() -> None:
    with pytest.raises(ValueError, match="finite chain"):
        stationary(rule_weighted(0.4, 1.0), np.arange(3.0), np.full(3, 0.7))


def test_a_track_of_one_level_stays_there() -> None:
    found = stationary(rule_wang(), np.array([4.0]), np.array([0.75]))
    assert found.occupancy.tolist() == pytest.approx([1.0])
    assert found.overall_correct == pytest.approx(0.75)
    assert found.mean_reversal is None


def test_a_track_that_nothing_ends_ends_by_itself_and_says_so() -> None:
    """Who is always right never reverses (psychopy#1046)."""
    stop = Stop((("reversals", 10),), most=30)
    track = start_track("t", (1, 2, 3), rule_levitt(), stop)
    for _ in range(29):
        track = answer(track, True)
    assert track.stopped_by is None
    assert answer(track, True).stopped_by == "most 30"


@pytest.mark.parametrize(("start", "shown"), [(None, 9), (1, 1), (4, 5), (6, 7), (40, 9)])
def test_a_track_starts_at_the_level_nearest_its_start(start: int | None, shown: int) -> None:
    assert start_track("t", (1, 3, 5, 7, 9), rule_wang(), NEVER, start).level == shown
