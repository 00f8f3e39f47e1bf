"""The mixed model and the Bradley-Terry scale against known truths and a published scale."""

import numpy as np
import pandas as pd
import pytest

from analysis.bradley_terry import bradley_terry, scale
from analysis.marginal import Cells, Crossed, Grouped
from analysis.mixed import cells_of, mixed_logistic
from tests.analysis.reference_mixed import laplace, reference


def answers(seed: int, mean: float, people: float, motions: float) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(seed)
    who, which = np.meshgrid(np.arange(35), np.arange(8), indexing="ij")
    odds = mean + people * rng.standard_normal((35, 1)) + motions * rng.standard_normal(8)
    return who.ravel(), which.ravel(), (rng.random((35, 8)) < 1 / (1 + np.exp(-odds))).ravel()


def test_coverage_of_the_mean_log_odds() -> None:
    held = []
    for seed in range(20):
        found = mixed_logistic(*answers(seed, 0.6, 0.8, 0.7))
        assert found.low is not None
        assert found.high is not None
        held.append(found.low <= 0.6 <= found.high)
    assert np.mean(held) >= 0.8


def test_without_spread_it_is_the_plain_log_odds() -> None:
    people, motions, chose = answers(1, 0.5, 0.0, 0.0)
    found = mixed_logistic(people, motions, chose)
    assert found.estimate == pytest.approx(np.log(chose.mean() / (1 - chose.mean())), abs=0.05)


def test_it_agrees_with_the_variational_fit_of_statsmodels() -> None:
    from statsmodels.genmod.bayes_mixed_glm import BinomialBayesMixedGLM

    people, motions, chose = answers(3, 0.6, 0.8, 0.7)
    found = mixed_logistic(people, motions, chose)
    table = pd.DataFrame({"y": chose.astype(int), "p": people, "m": motions})
    model = BinomialBayesMixedGLM.from_formula("y ~ 1", {"p": "0 + C(p)", "m": "0 + C(m)"}, table)
    other = model.fit_vb()
    assert found.estimate == pytest.approx(float(other.fe_mean[0]), abs=0.15)
    # The variational standard deviation is too small, which is why it is not used.
    assert found.low is not None
    assert (found.estimate - found.low) / 2 > float(other.fe_sd[0])


def test_what_it_refuses() -> None:
    people, motions = np.repeat(np.arange(5), 2), np.tile(np.arange(2), 5)
    assert mixed_logistic(people, motions, np.ones(10)).estimate is None
    alone = mixed_logistic(np.zeros(20), np.zeros(20), np.arange(20) < 14)
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


def drawn(rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    """Answers of any size, effect and spread, the sparse and the one-sided among them."""
    people, motions, repeats = (
        int(rng.choice(c)) for c in ([1, 2, 3, 6, 12, 20], [1, 2, 4, 8], [1, 1, 3])
    )
    mean, by_person, by_motion = (
        rng.choice([0, 0.7, 2, 4]),
        rng.choice([0, 0.5, 1.5, 3]),
        rng.choice([0, 0.5, 1]),
    )
    odds = (
        mean
        + by_person * rng.standard_normal((people, 1, 1))
        + by_motion * rng.standard_normal((1, motions, 1))
    )
    chose = rng.random((people, motions, repeats)) < 1 / (1 + np.exp(-odds))
    who, which, _ = np.indices(chose.shape)
    return who.ravel(), which.ravel(), chose.ravel()


def disagreements(sets: int, seed: int) -> tuple[list[str], int, int]:
    """Data sets whose fit is not the reference's, those compared and those refused."""
    told, compared, refused = [], 0, 0
    for number in range(sets):
        people, motions, chose = drawn(np.random.default_rng([seed, number]))
        found = mixed_logistic(people, motions, chose)
        cells = cells_of(people, motions, chose)
        if found.estimate is None:
            refused += 1
            assert ": not estimable, " in found.method
            continue
        assert found.low is not None
        assert found.high is not None
        persons, kinds = cells.total.shape
        n = cells.total.sum()
        estimate, width = reference(cells, 1 < persons < n, 1 < kinds < n)
        compared += 1
        own = found.high - found.low
        if not (abs(found.estimate - estimate) <= 0.02 and abs(own - width) <= 0.02 * width):
            told.append(
                f"{number}: {found.estimate:.3f}, width {own:.3f}, reference {estimate:.3f}, "
                f"width {width:.3f}, {found.method}"
            )
    return told, compared, refused


def test_fits_agree_with_a_slow_reference() -> None:
    told, compared, _ = disagreements(25, 1)
    assert compared >= 12
    assert told == []


@pytest.mark.slow
def test_two_thousand_fits_agree_with_a_slow_reference() -> None:
    told, compared, refused = disagreements(2000, 2)
    print(f"\n{compared} compared, {refused} refused, {len(told)} differ", *told, sep="\n")
    assert compared >= 1000
    assert len(told) <= 5


def coverage(spread: float, sets: int) -> tuple[float, int]:
    """Of the 95 % interval under study two's own design: 35 people, 8 motions, one answer each."""
    held, refused = [], 0
    for seed in range(sets):
        found = mixed_logistic(*answers(seed, 0.65, spread, 0.0))
        if found.low is None or found.high is None:
            refused += 1
        else:
            held.append(found.low <= 0.65 <= found.high)
    return float(np.mean(held)), refused


@pytest.mark.slow
@pytest.mark.parametrize("spread", [0.0, 0.3, 0.5, 1.0, 1.5, 2.0])
def test_coverage_under_the_protocols_own_design(spread: float) -> None:
    found, refused = coverage(spread, 1000)
    print(f"\nspread {spread}: coverage {found:.3f}, {refused} of 1,000 refused")
    assert 0.93 <= found <= 0.97


@pytest.mark.parametrize("spread", [0.0, 1.0, 2.0])
def test_coverage_in_a_thin_sample(spread: float) -> None:
    """40 sets at .95: three binomial standard errors are .103."""
    found, refused = coverage(spread, 40)
    assert found >= 0.95 - 0.104
    assert refused == 0


def test_gradients_are_those_of_the_values() -> None:
    rng = np.random.default_rng(0)
    total = rng.integers(0, 4, (7, 5)).astype(float)
    cells = Cells(rng.binomial(total.astype(int), 0.7).astype(float), total)
    for marginal, theta in (
        (Crossed(cells), np.array([0.4, 1.3, 0.6])),
        (Grouped(cells.along(0)), np.array([0.4, 2.5])),
        (Grouped(cells.along(1)), np.array([-0.4, 0.3])),
    ):
        steps = 1e-5 * np.eye(len(theta))
        differences = [(marginal(theta + s)[0] - marginal(theta - s)[0]) / 2e-5 for s in steps]
        assert marginal(theta)[1] == pytest.approx(differences, abs=2e-5)
        if isinstance(marginal, Grouped):
            slopes = [(marginal(theta + s)[1] - marginal(theta - s)[1]) / 2e-5 for s in steps]
            assert marginal.curvature(theta) == pytest.approx(np.array(slopes), abs=1e-4)


def test_an_overshoot_of_the_inner_search_is_not_kept() -> None:
    """Large spreads make a full Newton step overshoot: the value must still be the mode's."""
    rng = np.random.default_rng(1)
    total = np.full((6, 8), 3.0)
    cells = Cells(
        rng.binomial(3, np.where(np.arange(6)[:, None] < 3, 0.0, 0.5), (6, 8)) * 1.0, total
    )
    for theta in ([-3.0, 9.0, 0.1], [6.0, 9.0, 4.0], [-12.0, 10.0, 10.0]):
        value, _ = Crossed(cells)(np.array(theta))
        assert value == pytest.approx(laplace(theta[0], (theta[1], theta[2]), cells), abs=1e-7)


def test_people_who_are_each_of_one_mind_give_no_interval() -> None:
    people, motions = np.repeat(np.arange(10), 8), np.tile(np.arange(8), 10)
    found = mixed_logistic(people, motions, people < 7)
    assert (found.estimate, found.low, found.p) == (None, None, None)
    assert "separate completely: within each of the people" in found.method
    found = mixed_logistic(people, motions, motions < 5)
    assert found.estimate is None
    assert "within each of the motions" in found.method


def test_a_variance_of_zero_is_said_and_left_out() -> None:
    """Everyone chooses a in six of eight: people differ less than chance would have it."""
    people, motions = np.repeat(np.arange(10), 8), np.tile(np.arange(8), 10)
    chose = (motions + people) % 8 < 6
    found = mixed_logistic(people, motions, chose)
    assert (found.sd_people, found.sd_motions) == (0.0, 0.0)
    assert found.estimate == pytest.approx(np.log(3))
    assert found.method.endswith("; of variance 0 and left out: motions, people")


def test_one_answer_a_person_leaves_motions_to_vary() -> None:
    rng = np.random.default_rng(2)
    motions = np.arange(80) % 8
    chose = rng.random(80) < 1 / (1 + np.exp(-np.linspace(-1.5, 2.5, 8)[motions]))
    found = mixed_logistic(np.arange(80), motions, chose)
    assert found.sd_people is None
    assert found.sd_motions is not None
    assert found.sd_motions > 0.3
    assert "random intercepts of motions" in found.method
