"""Receiver curves and agreement against published cases."""

import numpy as np
import pandas as pd
import pytest

from analysis.naturalness import (
    Labels,
    agreement,
    clip_measures,
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
