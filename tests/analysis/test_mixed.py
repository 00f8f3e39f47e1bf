"""The mixed model and the Bradley-Terry scale against known truths and a published scale."""

import numpy as np
import pandas as pd
import pytest

from analysis.bradley_terry import bradley_terry, scale
from analysis.mixed import mixed


def answers(seed: int, mean: float, people: float, motions: float) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(seed)
    who, which = np.meshgrid(np.arange(35), np.arange(8), indexing="ij")
    odds = mean + people * rng.standard_normal((35, 1)) + motions * rng.standard_normal(8)
    return who.ravel(), which.ravel(), (rng.random((35, 8)) < 1 / (1 + np.exp(-odds))).ravel()


def test_coverage_of_the_mean_log_odds() -> None:
    held = []
    for seed in range(20):
        found = mixed(*answers(seed, 0.6, 0.8, 0.7))
        assert found.low is not None
        assert found.high is not None
        held.append(found.low <= 0.6 <= found.high)
    assert np.mean(held) >= 0.8


def test_without_spread_it_is_the_plain_log_odds() -> None:
    people, motions, chose = answers(1, 0.5, 0.0, 0.0)
    found = mixed(people, motions, chose)
    assert found.estimate == pytest.approx(np.log(chose.mean() / (1 - chose.mean())), abs=0.05)


def test_it_agrees_with_the_variational_fit_of_statsmodels() -> None:
    from statsmodels.genmod.bayes_mixed_glm import BinomialBayesMixedGLM

    people, motions, chose = answers(3, 0.6, 0.8, 0.7)
    found = mixed(people, motions, chose)
    table = pd.DataFrame({"y": chose.astype(int), "p": people, "m": motions})
    model = BinomialBayesMixedGLM.from_formula("y ~ 1", {"p": "0 + C(p)", "m": "0 + C(m)"}, table)
    other = model.fit_vb()
    assert found.estimate == pytest.approx(float(other.fe_mean[0]), abs=0.15)
    # The variational standard deviation is too small, which is why it is not used.
    assert found.low is not None
    assert (found.estimate - found.low) / 2 > float(other.fe_sd[0])


def test_what_it_refuses() -> None:
    people, motions = np.repeat(np.arange(5), 2), np.tile(np.arange(2), 5)
    assert mixed(people, motions, np.ones(10)).estimate is None
    alone = mixed(np.zeros(20), np.zeros(20), np.arange(20) < 14)
    assert alone.estimate == pytest.approx(np.log(14 / 6))


def test_baseball_of_agresti() -> None:
    """American League East 1987 (Agresti 1990, table 10.10), strengths above Baltimore's."""
    wins = [
        [0, 7, 9, 7, 7, 9, 11],
        [6, 0, 7, 5, 11, 9, 9],
        [4, 6, 0, 7, 7, 8, 12],
        [6, 8, 6, 0, 6, 7, 10],
        [6, 2, 6, 7, 0, 7, 12],
        [4, 4, 5, 6, 6, 0, 6],
        [2, 4, 1, 3, 1, 7, 0],
    ]
    strength = bradley_terry(np.array(wins))
    assert strength.sum() == pytest.approx(0, abs=1e-9)
    assert strength[:6] - strength[6] == pytest.approx(
        [1.5814, 1.4364, 1.2945, 1.2476, 1.1077, 0.6839], abs=1e-4
    )


def test_a_method_that_never_lost_has_no_strength() -> None:
    assert np.isnan(bradley_terry(np.array([[0, 5, 5], [0, 0, 3], [0, 2, 0]]))).all()


def test_the_scale_of_three_methods() -> None:
    rng = np.random.default_rng(0)
    truth = {"a": 1.0, "b": 0.0, "c": -1.0}
    rows = []
    for person in range(20):
        for _ in range(6):
            first, second = rng.permutation(list(truth))[:2]
            wins = rng.random() < 1 / (1 + np.exp(truth[second] - truth[first]))
            rows.append((f"p{person}", first, second, first if wins else second))
    columns = ["participant", "first_method", "second_method", "chosen_method"]
    found = scale(pd.DataFrame(rows, columns=columns), ("a", "b", "c"), rng)
    assert found is not None
    assert [entry.method for entry in found] == ["a", "b", "c"]
    for entry in found:
        assert entry.low is not None
        assert entry.high is not None
        assert entry.low < truth[entry.method] < entry.high
