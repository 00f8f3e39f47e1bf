"""How often tracks end at their first or last level: together as one by one, and what mends it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study.protocol.protocol import shipped
from study.trials.ends import SELDOM, Observers, ended, ends_of
from study.trials.plan import make_plan
from study.trials.reading import load_protocol, parse_protocol
from study.trials.rules import RULES
from study.trials.staircase import Stop, Track, answer, start_track
from study.trials.tasks import TASKS

LEVELS = (2, 4, 6, 8, 10, 12)
STOPS = (
    Stop((("visits", 4),)),
    Stop((("reversals", 3), ("trials", 12))),
    Stop((("visits", 3), ("reversals", 2)), all, 40),
    Stop((("reversals", 9),), any, 15),
)


def track_of(rule: str, stop: Stop, start: int | None = None) -> Track:
    return start_track("m/longer", LEVELS, RULES[rule](), stop, start)


@given(
    rule=st.sampled_from(["levitt", "wang", "weighted"]),
    stop=st.sampled_from(STOPS),
    start=st.sampled_from([None, 2, 7]),
    seed=st.integers(0, 99),
)
def test_tracks_together_end_where_each_ends_alone(
    rule: str, stop: Stop, start: int | None, seed: int
) -> None:
    track = track_of(rule, stop, start)
    right = np.random.default_rng(seed).uniform(0.3, 1, (5, len(LEVELS)))
    found = ended(track, right, np.random.default_rng(seed))
    draws = np.random.default_rng(seed).random((stop.most, 5))
    for n in range(5):
        alone = track
        for draw in draws[:, n]:
            alone = answer(alone, bool(draw < right[n, LEVELS.index(alone.level)]))
            if alone.stopped_by is not None:
                break
        assert LEVELS[found[n]] == alone.answers[-1][0]
        assert alone.ended_at_edge == (found[n] in (0, len(LEVELS) - 1))


def step_at(threshold: float, levels: np.ndarray) -> np.ndarray:
    return np.where(levels > threshold, 0.99, 0.5)


def test_who_sees_nothing_ends_at_the_last_level_and_more_levels_mend_it() -> None:
    people = Observers(13.0, 0.0, 0.5, step_at)
    track = track_of("levitt", Stop((("visits", 10),)))
    row = ends_of("m/longer", track, people, None, np.random.default_rng(1))
    assert row["ends_last"] > 0.7
    assert row["ends_first"] == 0
    assert [person["threshold"] for person in row["people"]] == [13.0]
    better = next(c for c in row["changes"] if c["change"].startswith("levels"))
    assert better["levels"][-1] > 13
    assert better["at_ends"] < SELDOM
    assert not any(c["change"].startswith("levels from 0") for c in row["changes"])


def test_no_level_is_proposed_that_cannot_be() -> None:
    people = Observers(9.0, 1.0, 0.5, step_at)
    track = track_of("wang", Stop((("visits", 10),)))
    row = ends_of("m/shorter", track, people, 14, np.random.default_rng(1))
    proposed = {c["change"] for c in row["changes"] if c["change"].startswith("levels")}
    assert proposed == {"levels to 14"}
    assert {len(p) for p in row["people"]} == {3}
    assert len(row["people"]) == 5


def test_a_rule_with_a_posterior_is_run_answer_by_answer() -> None:
    found = ended(track_of("questplus", Stop((("trials", 6),))), np.full((3, 6), 0.9),
                  np.random.default_rng(1))  # fmt: skip
    assert set(found) <= set(range(6))


@pytest.mark.parametrize(
    ("name", "references"),
    [
        ("jnd-center", {"locomotion": 10, "dance": 10}),
        ("jnd-start-end", {"locomotion-1": 9, "locomotion-2": 15, "activity-1": 16}),
    ],
)
def test_shipped_tracks_end_within_their_levels_as_often_as_the_dissertations_allow(
    name: str, references: dict[str, int]
) -> None:
    """No start does better by much, and the start and stop of before did worse."""

    def at_ends(text: str) -> dict[str, dict]:
        plan = make_plan(parse_protocol(text), references, 0)
        ends = TASKS[plan.protocol.file.task].ends
        assert ends is not None
        return {row["track"]: row for row in ends(plan, np.random.default_rng(1))}

    text = shipped()[name].read_text(encoding="utf-8")
    stop = '{ visits = 10, reversals = 8, combine = "all" }'
    assert stop in text
    now = at_ends(text)
    lines = text.replace(stop, "{ visits = 10 }").splitlines()
    before = at_ends("\n".join(line for line in lines if not line.startswith("start = ")))
    assert now.keys() == before.keys()
    for track, row in now.items():
        held = row["ends_first"] + row["ends_last"]
        assert held < 0.75 * (before[track]["ends_first"] + before[track]["ends_last"])
        starts = [c["at_ends"] for c in row["changes"] if c["change"].startswith("start")]
        assert held < min(starts) + 0.1


def test_studies_without_staircases_have_none() -> None:
    plan = make_plan(load_protocol("jnd-pilot"), dict.fromkeys(
        ("locomotion-1", "locomotion-2", "activity-1"), 16), 0)  # fmt: skip
    ends = TASKS[plan.protocol.file.task].ends
    assert ends is not None
    assert ends(plan, np.random.default_rng(1)) == []
