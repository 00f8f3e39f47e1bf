"""Preference when people and motions differ: a logistic model with both as random effects.

Pooled χ² takes 280 answers of 35 people to 8 motions as 280 independent ones. Here the log odds
of choosing a are `β + person + motion` with normal intercepts of people and of motions, crossed.
It is fitted by maximum likelihood under the Laplace approximation (as lme4 does): statsmodels'
Bayesian mixed GLM offers a variational posterior whose factors are independent, which understates
the uncertainty of β, and that uncertainty is what the model is for.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize
from scipy.special import expit, log1p, stdtr, stdtrit

from analysis.psychometric.functions import Array

LARGEST_SD = 6.0  # of the random intercepts, in log odds
LEAST_SD = 1e-3  # below it an effect does not vary
METHOD = "logistic mixed model, random intercepts of {}, Laplace approximation, Wald interval"
METHOD_PLAIN = "logistic model without random effects, Wald interval"


@dataclass(frozen=True)
class Mixed:
    """Log odds of choosing a in the average person and motion; None where not estimable."""

    estimate: float | None
    low: float | None
    high: float | None
    p: float | None
    method: str
    sd_people: float | None = None
    sd_motions: float | None = None


@dataclass(frozen=True, eq=False)
class _Cells:
    """Choices gathered by person and motion: counts (P, M) and which effects are random."""

    chose: Array
    total: Array
    people: bool
    motions: bool


def mixed(people: Array, motions: Array, chose_a: Array) -> Mixed:
    """Fit the model to single answers (N,): who, on which motion, and whether a was chosen."""
    cells = _cells(people, motions, chose_a)
    effects = [
        n for n, is_random in (("people", cells.people), ("motions", cells.motions)) if is_random
    ]
    method = METHOD.format(" and ".join(effects)) if effects else METHOD_PLAIN
    count, right = cells.total.sum(), cells.chose.sum()
    if right in (0, count):
        return Mixed(None, None, None, None, f"{method}: not estimable, every answer is the same")
    free = [cells.people, cells.motions]
    bounds = [(-15.0, 15.0)] + [(0.0, LARGEST_SD if is_free else 0.0) for is_free in free]
    start = np.array([np.log(right / (count - right)), *(0.5 * np.array(free))])
    found = minimize(lambda theta: -_laplace(theta, cells), start, method="L-BFGS-B", bounds=bounds)
    beta, sd_people, sd_motions = map(float, found.x)
    error = _standard_error(found.x, cells)
    if not np.isfinite(error) or abs(beta) > 12:
        why = f"{method}: not estimable, the answers are too uniform"
        return Mixed(None, None, None, None, why)
    df = _degrees(cells, sd_people, sd_motions)
    reach = float(stdtrit(df, 0.975)) * error
    return Mixed(
        beta,
        beta - reach,
        beta + reach,
        float(2 * stdtr(df, -abs(beta / error))),
        f"{method} (t with {df} df)",
        sd_people if cells.people else None,
        sd_motions if cells.motions else None,
    )


def _degrees(cells: _Cells, sd_people: float, sd_motions: float) -> int:
    """One less than the fewest levels of an effect that varies: what the interval rests on.

    With eight motions a normal quantile covers .88 of simulated sets, this one about .95.
    """
    persons, kinds = cells.total.shape
    counts = [n for n, sd in ((persons, sd_people), (kinds, sd_motions)) if sd > LEAST_SD]
    return max(min(counts, default=persons if cells.people else int(cells.total.sum())) - 1, 1)


def _cells(people: Array, motions: Array, chose_a: Array) -> _Cells:
    persons, person = np.unique(people, return_inverse=True)
    kinds, kind = np.unique(motions, return_inverse=True)
    total, chose = np.zeros((2, len(persons), len(kinds)))
    np.add.at(total, (person, kind), 1.0)
    np.add.at(chose, (person, kind), np.asarray(chose_a, float))
    # One answer a person (or a motion) cannot tell its variance from that of the answers.
    return _Cells(chose, total, 1 < len(persons) < len(people), 1 < len(kinds) < len(people))


def _laplace(theta: Array, cells: _Cells) -> float:
    """Log likelihood at β and the two standard deviations, random effects at their modes."""
    beta, sd_people, sd_motions = theta
    persons, kinds = cells.total.shape
    scale = np.repeat([sd_people, sd_motions], [persons, kinds])
    u = np.zeros(persons + kinds)
    value = -np.inf
    for _ in range(50):
        effect = scale * u
        eta = beta + effect[:persons, None] + effect[None, persons:]
        new = _joint(eta, u, cells)
        p = expit(eta)
        slope = cells.chose - cells.total * p
        gradient = scale * np.concatenate([slope.sum(1), slope.sum(0)]) - u
        weight = cells.total * p * (1 - p)
        information = _information(weight, scale)
        if new - value < 1e-9 * max(1.0, abs(new)):
            value = new
            break
        value = new
        u = u + np.linalg.solve(information, gradient)
    return value - 0.5 * float(np.linalg.slogdet(information)[1])


def _joint(eta: Array, u: Array, cells: _Cells) -> float:
    """Log likelihood of the answers and of the (standard normal) random effects."""
    softplus = np.maximum(eta, 0) + log1p(np.exp(-np.abs(eta)))
    return float((cells.chose * eta - cells.total * softplus).sum() - 0.5 * u @ u)


def _information(weight: Array, scale: Array) -> Array:
    persons = len(weight)
    top = np.concatenate([np.diag(weight.sum(1)), weight], 1)
    bottom = np.concatenate([weight.T, np.diag(weight.sum(0))], 1)
    whole = np.concatenate([top, bottom]) * scale[:, None] * scale[None, :]
    assert persons + weight.shape[1] == len(scale)
    return np.eye(len(scale)) + whole


def _standard_error(theta: Array, cells: _Cells) -> float:
    """Of β, from the curvature over β and the standard deviations that are not at 0."""
    kept = [0, *(place for place in (1, 2) if theta[place] > LEAST_SD)]
    step = 1e-3 * np.maximum(1.0, np.abs(theta))

    def value(*moves: tuple[int, float]) -> float:
        moved = theta.copy()
        for place, sign in moves:
            moved[place] += sign * step[place]
        return _laplace(moved, cells)

    centre = value()
    hessian = np.empty((len(kept), len(kept)))
    for row, i in enumerate(kept):
        for column, j in enumerate(kept):
            if i == j:
                second = value((i, 1.0)) - 2 * centre + value((i, -1.0))
            else:
                corners = [value((i, a), (j, b)) * a * b for a in (1.0, -1.0) for b in (1.0, -1.0)]
                second = sum(corners) / 4
            hessian[row, column] = second / (step[i] * step[j])
    try:
        variance = float(np.linalg.inv(-hessian)[0, 0])
    except np.linalg.LinAlgError:
        return float("nan")
    return float(np.sqrt(variance)) if variance > 0 else float("nan")
