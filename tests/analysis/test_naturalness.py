"""Receiver curves and agreement against published cases."""

import numpy as np
import pandas as pd
import pytest

from analysis.naturalness import (
    Labels,
    agreement,
    called_unnatural,
    clip_measures,
    delong,
    krippendorff_alpha,
    labels,
    receiver_curve,
    scores_of,
)


def test_area_of_hanley_and_mcneil_1982() -> None:
    """Their table I: 58 normal and 51 abnormal images rated 1 to 5, area .893."""
    normal, abnormal = [33, 6, 6, 11, 2], [3, 2, 2, 11, 33]
    answers = Labels(("reader",), tuple("12345"), np.array([abnormal], float),
                     np.array([normal], float))  # fmt: skip
    scores = np.arange(1.0, 6)
    found = receiver_curve("rating", scores, answers, np.random.default_rng(0), 200)
    assert found is not None
    assert found.area == pytest.approx(0.893, abs=5e-4)
    assert np.trapezoid(found.hits, found.false_alarms) == pytest.approx(found.area)
    assert found.low < found.area < found.high


def test_alpha_of_krippendorff_2011() -> None:
    """Four observers, twelve units, missing values: nominal α = .743 (his section D)."""
    n = np.nan
    ratings = np.array(
        [
            [1, 2, 3, 3, 2, 1, 4, 1, 2, n, n, n],
            [1, 2, 3, 3, 2, 2, 4, 1, 2, 5, n, 3],
            [n, 3, 3, 3, 2, 3, 4, 2, 2, 5, 1, n],
            [1, 2, 3, 3, 2, 4, 4, 1, 2, 5, 1, n],
        ]
    )
    assert krippendorff_alpha(ratings) == pytest.approx(0.743, abs=5e-4)


def test_agreement_at_its_ends() -> None:
    alike = Labels(("a", "b"), ("x", "y"), np.array([[1.0, 0], [1, 0]]),
                   np.array([[0.0, 1], [0, 1]]))  # fmt: skip
    assert agreement(alike) == {"krippendorff_alpha": 1.0, "pairwise": 1.0}
    nobody = Labels(("a",), ("x",), np.array([[1.0]]), np.array([[0.0]]))
    assert agreement(nobody) == {"krippendorff_alpha": None, "pairwise": None}


def test_a_score_that_tells_and_one_that_does_not() -> None:
    rng = np.random.default_rng(2)
    clips, people = 24, 10
    score = rng.standard_normal(clips)
    rows = [
        {
            "participant": f"p{person}",
            "clip": f"c{clip:02d}",
            "response": "unnatural" if rng.random() < 1 / (1 + np.exp(-3 * score[clip])) else
            "natural",
        }
        for person in range(people)
        for clip in range(clips)
    ]  # fmt: skip
    found = labels(pd.DataFrame(rows))
    good = receiver_curve("good", score, found, rng)
    poor = receiver_curve("poor", rng.standard_normal(clips), found, rng)
    assert good is not None
    assert poor is not None
    assert good.low > 0.5
    assert poor.low < 0.5 < poor.high


def test_measures_of_the_manifest_are_flattened() -> None:
    entry = {"measures": {"cost": 2, "feet": {"slide": 0.5, "note": "x"}, "flag": True}}
    assert clip_measures(entry) == {"cost": 2.0, "feet.slide": 0.5}
    assert clip_measures({}) == {}
    table = scores_of(("a", "b"), {"a": entry})
    assert np.isnan(table["cost"][1])


def test_one_kind_of_answer_has_no_curve() -> None:
    only = Labels(("a",), ("x",), np.array([[1.0]]), np.array([[0.0]]))
    assert receiver_curve("s", np.array([1.0]), only, np.random.default_rng(0)) is None


def two_scores(rng: np.random.Generator, clips: int, apart: float) -> dict[str, np.ndarray]:
    unnatural = (np.arange(clips) % 3 == 0).astype(float)
    shared = rng.standard_normal(clips) + unnatural
    return {
        "called": unnatural,
        "one": shared + rng.standard_normal(clips) + apart * unnatural,
        "other": shared + rng.standard_normal(clips),
    }


def test_delong_is_the_plain_form_with_its_components_by_pairs() -> None:
    """DeLong, DeLong and Clarke-Pearson (1988), eq. 4 to 6, pair by pair, with ties."""
    rng = np.random.default_rng(4)
    drawn = two_scores(rng, 60, 0.4)
    scores = {name: np.round(drawn[name], 1) for name in ("one", "other")}
    bad = drawn["called"] == 1
    areas, hits, spared = [], [], []
    for values in scores.values():
        pairs = (np.sign(values[bad][:, None] - values[~bad][None]) + 1) / 2
        areas.append(pairs.mean())
        hits.append(pairs.mean(axis=1))
        spared.append(pairs.mean(axis=0))
    spread = np.cov(hits) / bad.sum() + np.cov(spared) / (~bad).sum()
    error = np.sqrt(spread[0, 0] + spread[1, 1] - 2 * spread[0, 1])
    found = delong(scores, "one", "other", drawn["called"])
    assert found is not None
    assert found.areas == pytest.approx(areas)
    assert found.z == pytest.approx((areas[0] - areas[1]) / error)
    assert found.high - found.difference == pytest.approx(1.959964 * error, rel=1e-6)
    assert found.clips == 60


def test_delong_errs_as_often_as_it_says_and_sees_a_better_score() -> None:
    rng = np.random.default_rng(9)
    found = []
    for apart in (0.0, 1.5):
        tests = [two_scores(rng, 90, apart) for _ in range(400)]
        ps = [delong(t, "one", "other", t["called"]) for t in tests]
        found.append(np.mean([p is not None and p.p < 0.05 for p in ps]))
    assert 0.025 < found[0] < 0.085
    assert found[1] > 0.6


def test_delong_needs_clips_of_both_kinds_and_leaves_out_what_nobody_called() -> None:
    rng = np.random.default_rng(1)
    drawn = two_scores(rng, 12, 0.0)
    assert delong(drawn, "one", "other", np.zeros(12)) is None
    drawn["called"][:3] = np.nan
    drawn["one"][5] = np.nan
    found = delong(drawn, "one", "other", drawn["called"])
    assert found is not None
    assert found.clips == 8


def test_a_clip_is_called_what_most_people_call_it() -> None:
    table = pd.DataFrame(
        [
            {"participant": f"p{person}", "clip": clip, "response": answer}
            for clip, answers in {"a": "nnu", "b": "uun", "c": "nu"}.items()
            for person, answer in enumerate(
                {"n": "natural", "u": "unnatural"}[letter] for letter in answers
            )
        ]
    )
    called = called_unnatural(labels(table))
    assert called[:2].tolist() == [0, 1]
    assert np.isnan(called[2])
