"""The user study of the weights (Wang 2005, IV.4.1) from ratings drawn to its printed figures.

He prints means of squares and F: with 52 ratings the methods' sums differ by 19 (MS 6.94) in
realism and by 8 (MS 1.23) in noticeability, the orders' by 7 (MS .94). The ratings below have
those sums and his F values; his data themselves are not printed.
"""

from pathlib import Path

import pytest

from analysis.report import write_report
from tests.analysis import records

# Twenty-six people, thirteen in each order; a digit is a rating.
REALISM = {"lee": "42222232432425532115333223", "wang": "54323244442434243543444424"}
NOTICEABILITY = {"lee": "34523252532422424243343542", "wang": "32345533243423434353444444"}
BETTER, NATURAL = "31424332334434323113312234", "22422243242242334312332333"


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> dict:
    sessions = {}
    for person in range(26):
        order = "lee-wang" if person < 13 else "wang-lee"
        ratings = {
            method: {
                "realism": int(REALISM[method][person]),
                "noticeability": int(NOTICEABILITY[method][person]),
            }
            for method in ("lee", "wang")
        }
        compared = {"looks better": int(BETTER[person]), "more natural": int(NATURAL[person])}
        sessions[f"p{person + 1:02d}"] = records.rating_rows(ratings, order, compared)
    data = records.write_dataset(
        tmp_path_factory.mktemp("weights"), records.rating_protocol(), sessions
    )
    return write_report([data]).document["studies"][0]


def found(study: dict, question: str, test: str) -> list[dict]:
    return [e for e in study["ratings"] if e["question"] == question and e["test"] == test]


@pytest.mark.parametrize(
    ("question", "effect", "f", "p", "square"),
    [
        ("realism", "method", 6.39, 0.01, 6.94),
        ("realism", "order", 0.87, 0.35, 0.94),
        ("noticeability", "method", 1.24, 0.27, 1.23),
    ],
)
def test_analysis_of_variance(
    study: dict, question: str, effect: str, f: float, p: float, square: float
) -> None:
    (test,) = found(study, question, f"ANOVA, ratings independent: {effect}")
    assert test["df"] == [1, 48]
    assert test["statistic"] == pytest.approx(f, abs=0.005)
    assert test["mean_square"] == pytest.approx(square, abs=0.005)
    # F(1, 48) = .87 has p = .3556, which he prints as .35.
    assert test["p"] == pytest.approx(p, abs=0.0065)


def test_mixed_design_beside_it(study: dict) -> None:
    (test,) = found(study, "realism", "ANOVA, mixed design: method")
    assert test["df"] == [1, 24]


def test_order_is_not_significant_and_the_orders_are_grouped(study: dict) -> None:
    for question in ("realism", "noticeability"):
        order = found(study, question, "rank-sum, order")
        assert [test["groups"] for test in order] == [
            ["lee-wang: lee", "wang-lee: lee"],
            ["lee-wang: wang", "wang-lee: wang"],
        ]
        assert all(test["p"] >= 0.05 for test in order)
        (grouped,) = found(study, question, "signed-rank, method")
        assert grouped["groups"] == ["lee", "wang"]


@pytest.mark.parametrize(("question", "p"), [("realism", 0.01), ("noticeability", 0.34)])
def test_signed_rank_of_the_grouped_methods(study: dict, question: str, p: float) -> None:
    (test,) = found(study, question, "signed-rank, method")
    assert test["p"] == pytest.approx(p, abs=0.005)
    assert (test["p"] < 0.05) == (question == "realism")
    assert test["low"] < test["effect_size"] < test["high"]


def test_ordinal_regression_has_the_same_conclusions(study: dict) -> None:
    (realism,) = found(study, "realism", "ordinal regression: method")
    (noticeable,) = found(study, "noticeability", "ordinal regression: method")
    assert realism["p"] < 0.05 < noticeable["p"]
    assert realism["effect_size"] > 0


@pytest.mark.parametrize(
    ("question", "mean", "sd"), [("looks better", 2.73, 1.00), ("more natural", 2.69, 0.84)]
)
def test_table_iv_3(study: dict, question: str, mean: float, sd: float) -> None:
    (test,) = found(study, question, "signed-rank, midpoint")
    assert test["mean"] == pytest.approx(mean, abs=0.005)
    assert test["sd"] == pytest.approx(sd, abs=0.005)
    assert test["p"] < 0.05


def test_sentences(study: dict) -> None:
    told = " ".join(study["text"])
    assert "wang being rated higher" in told
    assert "did not differ significantly" in told


def test_an_order_that_matters_keeps_the_orders_apart(tmp_path: Path) -> None:
    sessions = {}
    for person in range(20):
        order = "lee-wang" if person < 10 else "wang-lee"
        high = 2 if order == "lee-wang" else 0
        rating = 2 + high + person % 2
        sessions[f"p{person:02d}"] = records.rating_rows(
            {"lee": {"realism": rating}, "wang": {"realism": rating + (person % 3 == 0)}}, order, {}
        )
    data = records.write_dataset(tmp_path, records.rating_protocol(), sessions)
    study = write_report([data]).document["studies"][0]
    assert len(found(study, "realism", "signed-rank, method")) == 2
