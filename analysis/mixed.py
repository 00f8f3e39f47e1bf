"""Preference when people and motions differ: a logistic model with both as random effects.

Pooled χ² takes 280 answers of 35 people to 8 motions as 280 independent ones. Here the log odds
of choosing a are `β + person + motion` with normal intercepts of people and of motions, crossed.
It is fitted by maximum likelihood: under the Laplace approximation where both vary (as lme4
does), by adaptive quadrature where one does, and without what does not vary. statsmodels'
Bayesian mixed GLM offers a variational posterior whose factors are independent, which understates
the uncertainty of β, and that uncertainty is what the model is for.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize
from scipy.special import expit, stdtr, stdtrit

from analysis.marginal import FINER, NODES, Cells, Crossed, Grouped
from analysis.psychometric.functions import Array

_EFFECTS = ("people", "motions")
_LARGEST_SD = 10.0  # of the random intercepts, in log odds: beyond it the answers set no bound
LEAST_SD = 1e-2  # below it an effect does not vary, and the model is fitted without it
LARGEST_MEAN = 15.0  # of the log odds
LARGEST_ERROR = 5.0  # of the log odds: an interval of twenty tells nothing, and hides a ridge
STARTS = ((1.0, 0.3, 0.3), (1.3, 1.2, 0.6), (2.0, 3.0, 0.3), (2.0, 6.0, 2.0), (1.0, 0.3, 1.5))
NEGLIGIBLE = 0.25  # share of β's variance below which who and what vary hardly matters to it
UNSETTLED = 0.01  # standard errors by which more nodes may move the estimate or the error
_STEP = 1e-4  # for the second derivatives, differences of an analytic gradient
LAPLACE = "Laplace approximation"
QUADRATURE = "adaptive Gauss-Hermite quadrature"
METHOD = "logistic mixed model, random intercepts of {}, {}, Wald interval"
_LEFT_OUT = "; of variance 0 and left out: "
METHOD_PLAIN = "logistic model without random effects, Wald interval"

# A log likelihood at θ = (β, standard deviations) with its gradient.
Marginal = Callable[[Array], tuple[float, Array]]


@dataclass(frozen=True)
class MixedFit:
    """Log odds of choosing a in the average person and motion; None where not estimable."""

    estimate: float | None
    low: float | None
    high: float | None
    p: float | None
    method: str
    sd_people: float | None = None
    sd_motions: float | None = None


def mixed_logistic(people: Array, motions: Array, chose_a: Array) -> MixedFit:
    """Fit the model to single answers (N,): who, on which motion, and whether a was chosen."""
    cells = cells_of(people, motions, chose_a)
    # One answer a person (or a motion) cannot tell its variance from that of the answers.
    varies = tuple(1 < size < cells.total.sum() for size in cells.total.shape)
    return fit_cells(cells, varies[0], varies[1])


def cells_of(people: Array, motions: Array, chose_a: Array) -> Cells:
    """Single answers gathered by person and motion."""
    persons, person = np.unique(people, return_inverse=True)
    kinds, kind = np.unique(motions, return_inverse=True)
    total, chose = np.zeros((2, len(persons), len(kinds)))
    np.add.at(total, (person, kind), 1.0)
    np.add.at(chose, (person, kind), np.asarray(chose_a, float))
    return Cells(chose, total)


def fit_cells(cells: Cells, people: bool, motions: bool) -> MixedFit:
    """Fit the cells with random intercepts of people, of motions, of both or of none.

    An effect whose variance is 0 at the maximum is left out and the rest fitted again: its
    standard deviation is then reported as 0.
    """
    random = (people, motions)
    count, right = cells.total.sum(), cells.chose.sum()
    if right in (0, count):
        return _refused(_method(random), "every answer is the same")
    for name, held, axis in zip(_EFFECTS, random, (0, 1), strict=True):
        groups = cells.along(axis)
        if held and ((groups.chose == 0) | (groups.chose == groups.total)).all():
            return _refused(
                _method(random),
                f"the answers separate completely: within each of the {name} they are all alike, "
                "so that the variance between them has no bound",
            )
    theta, hessian = _maximum(cells, random)
    settled = sum(random) != 1
    for nodes in FINER if not settled else ():
        settled = _settled(cells.along(random.index(True)), theta, random, hessian, nodes)
        if settled or nodes == FINER[-1]:
            break
        theta, hessian = _maximum(cells, random, nodes)
    for place, name in enumerate(_EFFECTS):
        if random[place] and theta[1 + place] < LEAST_SD:
            kept = [held and other != place for other, held in enumerate(random)]
            return _with_zero(fit_cells(cells, kept[0], kept[1]), name)
    if not settled:
        return _refused(_method(random), "nearly everyone answers alike each time")
    return _wald(cells, random, theta, hessian)


def _with_zero(fit: MixedFit, name: str) -> MixedFit:
    told = f"{fit.method}, {name}" if _LEFT_OUT in fit.method else f"{fit.method}{_LEFT_OUT}{name}"
    if name == "people":
        return replace(fit, method=told, sd_people=0.0)
    return replace(fit, method=told, sd_motions=0.0)


def _wald(cells: Cells, random: tuple[bool, ...], theta: Array, hessian: Array) -> MixedFit:
    """The estimate and its interval, or why the counts cannot give them."""
    method = _method(random)
    for name, sd in zip(_EFFECTS, theta[1:], strict=True):
        if sd > 0.999 * _LARGEST_SD:
            return _refused(method, f"the variance between {name} is at its bound")
    beta, error = float(theta[0]), _standard_error(hessian)
    if not error < LARGEST_ERROR or abs(beta) > 0.999 * LARGEST_MEAN:
        return _refused(method, "the answers are too uniform")
    df = _degrees(cells, theta, error)
    reach = float(stdtrit(df, 0.975)) * error
    return MixedFit(
        beta,
        beta - reach,
        beta + reach,
        float(2 * stdtr(df, -abs(beta / error))),
        f"{method} (t with {df:.3g} df)",
        float(theta[1]) if random[0] else None,
        float(theta[2]) if random[1] else None,
    )


def _settled(
    cells: Cells, theta: Array, random: tuple[bool, ...], hessian: Array, nodes: int
) -> bool:
    """Whether so many nodes leave the estimate and its standard error where they are.

    Groups that answer almost always alike have integrals far from normal, whose nodes miss; the
    spread between them is then known from a handful of answers, and no interval means anything.
    """
    finer, error = Grouped(cells, nodes), _standard_error(hessian)
    place = theta[[0, 1 + random.index(True)]]
    bent = finer.curvature(place)
    again = _standard_error(bent)
    if not np.isfinite(error) or not np.isfinite(again):
        return not np.isfinite(error) and not np.isfinite(again)
    moved = abs(np.linalg.solve(-bent, finer(place)[1])[0])
    return bool(moved < UNSETTLED * error and abs(again - error) < UNSETTLED * error)


def _refused(method: str, why: str) -> MixedFit:
    return MixedFit(None, None, None, None, f"{method}: not estimable, {why}")


def _method(random: tuple[bool, ...]) -> str:
    named = [name for name, held in zip(_EFFECTS, random, strict=True) if held]
    if not named:
        return METHOD_PLAIN
    return METHOD.format(" and ".join(named), LAPLACE if len(named) == 2 else QUADRATURE)


def _degrees(cells: Cells, theta: Array, error: float) -> float:
    """Degrees of freedom of the interval: what it rests on.

    One less than the fewest levels of an effect in the model: with eight motions that differ a
    normal quantile covers .92 of simulated sets, 7 about .96. Where the effects make up less than
    NEGLIGIBLE of β's variance, 7 would cover .98, as the interval rests on the answers: there they
    are Satterthwaite's (1946) of its parts.
    """
    sizes, answers = cells.total.shape, float(cells.total.sum())
    parts = [
        (float(sd**2) / size, size - 1)
        for sd, size in zip(theta[1:], sizes, strict=True)
        if sd > 0 and size > 1
    ]
    effects = sum(part for part, _ in parts)
    if effects >= NEGLIGIBLE * error**2:
        return float(min(df for _, df in parts))
    left = error**2 - effects
    spread = sum(part**2 / df for part, df in parts) + left**2 / max(answers - 1, 1.0)
    return float(np.clip(error**4 / spread, 1.0, max(answers - 1, 1.0)))


def _maximum(cells: Cells, random: tuple[bool, ...], nodes: int = NODES) -> tuple[Array, Array]:
    """θ = (β, both standard deviations, 0 where not random), and the Hessian of what is free."""
    free = np.flatnonzero([True, *random])
    marginal = _marginal(cells, random, nodes)
    right = float(cells.chose.sum())
    odds = float(np.clip(np.log(right / (cells.total.sum() - right)), -5, 5))
    # Standard deviations may cross 0 on the way: the likelihood is even in them, and a bound at 0,
    # where its slope is always 0, would hold a search that comes near.
    bounds = [(-b, b) for b in np.array([LARGEST_MEAN, _LARGEST_SD, _LARGEST_SD])[free]]
    found = [
        minimize(
            lambda theta: tuple(-part for part in marginal(theta)),
            np.array([start[0] * odds, *start[1:]])[free],
            jac=True,
            method="L-BFGS-B",
            bounds=bounds,
            options={"ftol": 1e-13, "gtol": 1e-7, "maxiter": 200},
        )
        for start in STARTS[: 1 if len(free) == 1 else None]
    ]
    best = min(found, key=lambda result: result.fun).x
    theta = np.zeros(3)
    theta[free] = best
    theta[1:] = np.abs(theta[1:])
    return theta, _hessian(marginal, theta[free])


def _marginal(cells: Cells, random: tuple[bool, ...], nodes: int) -> Marginal:
    if all(random):
        return Crossed(cells)
    if any(random):
        return Grouped(cells.along(random.index(True)), nodes)
    return _plain(float(cells.chose.sum()), float(cells.total.sum()))


def _plain(chose: float, total: float) -> Marginal:
    """The log likelihood of one proportion, at θ = (β,)."""

    def value(theta: Array) -> tuple[float, Array]:
        beta = float(theta[0])
        slope = chose - total * float(expit(beta))
        return chose * beta - total * float(np.logaddexp(0.0, beta)), np.array([slope])

    return value


def _hessian(marginal: Marginal, theta: Array) -> Array:
    """Second derivatives at `theta`: analytic by quadrature, else differences of the gradient."""
    if isinstance(marginal, Grouped):
        return marginal.curvature(theta)
    size = _STEP * np.maximum(1.0, np.abs(theta))
    moves = [
        (marginal(theta + step)[1] - marginal(theta - step)[1]) / (2 * step.sum())
        for step in np.diag(size)
    ]
    rows = np.array(moves)
    return (rows + rows.T) / 2


def _standard_error(hessian: Array) -> float:
    """Of β; nan where the likelihood does not fall away on every side."""
    values = np.linalg.eigvalsh(-hessian)
    if not np.isfinite(values).all() or values[0] <= 1e-9 * values[-1]:
        return float("nan")
    return float(np.sqrt(np.linalg.inv(-hessian)[0, 0]))
