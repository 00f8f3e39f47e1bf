"""The mixed model fitted slowly, for `analysis.mixed` to agree with.

No analytic derivative of the outer likelihood and no start but those named: quadrature with 61
nodes on each of many pieces for one grouping, Laplace's approximation with an inner search of its
own for two, a bounded general optimiser from many starts, and second differences wide enough for
what noise is left.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.optimize import minimize
from scipy.special import expit, stdtrit

from analysis.marginal import Cells

NODES = 61  # of each of several pieces, so that the integral is right for any group
PIECES = 24
BOUND = 10.0
ZERO = 1e-2
STARTS = [(b, p, m) for b in (0.5, 1.0, 2.0) for p, m in ((0.1, 0.1), (1.0, 0.5), (4.0, 1.0))]
DIFFERENCE = 2e-3


def log_joint(beta: float, scale: np.ndarray, u: np.ndarray, cells: Cells) -> float:
    persons = len(cells.total)
    eta = beta + (scale * u)[:persons, None] + (scale * u)[None, persons:]
    return float((cells.chose * eta - cells.total * np.logaddexp(0, eta)).sum() - u @ u / 2)


def laplace(beta: float, sd: tuple[float, float], cells: Cells) -> float:
    """Levenberg's method to the mode, from 0 every time."""
    persons, kinds = cells.total.shape
    scale = np.repeat(sd, (persons, kinds))
    incidence = np.zeros((persons * kinds, persons + kinds))
    rows, columns = np.divmod(np.arange(persons * kinds), kinds)
    incidence[np.arange(len(rows)), rows] = 1
    incidence[np.arange(len(rows)), persons + columns] = 1
    design, u, ridge = incidence * scale, np.zeros(persons + kinds), 1e-3
    value = log_joint(beta, scale, u, cells)
    for _ in range(300):
        p = expit(beta + design @ u)
        gradient = design.T @ (cells.chose.ravel() - cells.total.ravel() * p) - u
        weight = cells.total.ravel() * p * (1 - p)
        information = np.eye(len(u)) + design.T @ (weight[:, None] * design)
        if float(np.abs(gradient).max()) < 1e-9:
            break
        tried = u + np.linalg.solve(information + ridge * np.eye(len(u)), gradient)
        found = log_joint(beta, scale, tried, cells)
        if found >= value - 1e-13 * abs(value):
            u, value, ridge = tried, found, ridge / 10
        else:
            ridge *= 10
    return value - float(np.linalg.slogdet(information)[1]) / 2


def quadrature(beta: float, sd: float, chose: np.ndarray, total: np.ndarray) -> float:
    """Each group's integral over −9 to 9 by 61 nodes on each of 24 pieces, whatever its shape."""
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    edges = np.linspace(-9, 9, PIECES + 1)
    half = (edges[1] - edges[0]) / 2
    u = (edges[:-1, None] + half * (nodes + 1)).ravel()
    w = np.log(np.tile(half * weights, PIECES))
    eta = beta + sd * u
    logs = chose[:, None] * eta - total[:, None] * np.logaddexp(0, eta) - u * u / 2 + w
    top = logs.max(1)
    whole = np.log(np.exp(logs - top[:, None]).sum(1)) + top
    return float(whole.sum()) - len(chose) * np.log(2 * np.pi) / 2


def reference(cells: Cells, people: bool, motions: bool) -> tuple[float, float]:
    """The estimate and the width of its 95 % interval; nan where the likelihood sets no bound."""
    persons, kinds = cells.total.shape
    n, k = cells.total.sum(), cells.chose.sum()
    varying: list[tuple[float, int]] = []  # variances of β's parts, and their degrees of freedom
    if people and motions:
        theta, width = searched(lambda t: laplace(t[0], (abs(t[1]), abs(t[2])), cells), cells, 3)
        if abs(theta[1]) < ZERO or abs(theta[2]) < ZERO:
            return reference(cells, abs(theta[1]) >= ZERO, abs(theta[2]) >= ZERO)
        varying = [(theta[1] ** 2 / persons, persons - 1), (theta[2] ** 2 / kinds, kinds - 1)]
    elif people or motions:
        chose, total = (t.sum(1 if people else 0) for t in (cells.chose, cells.total))
        theta, width = searched(lambda t: quadrature(t[0], abs(t[1]), chose, total), cells, 2)
        if abs(theta[1]) < ZERO:
            return reference(cells, False, False)
        varying = [(theta[1] ** 2 / len(chose), len(chose) - 1)]
    else:
        theta, width = np.array([np.log(k / (n - k))]), float(np.sqrt(n / (k * (n - k))))
    if (np.abs(theta[1:]) > 0.999 * BOUND).any():
        return float("nan"), float("nan")
    effects = sum(part for part, _ in varying)
    if effects >= 0.25 * width**2:
        df = min(free for _, free in varying)
    else:
        rest = (width**2 - effects) ** 2 / (n - 1)
        df = width**4 / (sum(part**2 / free for part, free in varying) + rest)
    return float(theta[0]), float(2 * stdtrit(np.clip(df, 1, n - 1), 0.975) * width)


def searched(
    value: Callable[[np.ndarray], float], cells: Cells, size: int
) -> tuple[np.ndarray, float]:
    """The best of all starts by a bounded search, polished by a simplex; the standard error."""
    n, k = cells.total.sum(), cells.chose.sum()
    odds = float(np.log(k / (n - k)))
    bounds = [(-15.0, 15.0), *([(0.0, BOUND)] * (size - 1))]
    starts = [np.array([b * odds, *sds])[:size] for b, *sds in STARTS]
    loss = sorted((-value(start), place) for place, start in enumerate(starts))
    # From inside the bounds: at a standard deviation of 0 every slope is 0, and a search stops.
    rough = {"xatol": 1e-3, "fatol": 1e-6, "maxiter": 400}
    fine = {"xatol": 1e-6, "fatol": 1e-11, "maxiter": 2000}
    best: Any = None
    for options, places in ((rough, [starts[place] for _, place in loss[:3]]), (fine, None)):
        found = [
            minimize(
                lambda t: -value(t), place, method="Nelder-Mead", bounds=bounds, options=options
            )
            for place in (places or [best.x])
        ]
        best = min(found, key=lambda result: result.fun)
    assert best is not None
    hessian = np.empty((size, size))
    steps = DIFFERENCE * np.eye(size)
    for i, a in enumerate(steps):
        for j, b in enumerate(steps):
            corners = [value(best.x + s * a + t * b) * s * t for s in (1, -1) for t in (1, -1)]
            hessian[i, j] = sum(corners) / (4 * DIFFERENCE**2)
    with np.errstate(invalid="ignore"):
        return best.x, float(np.sqrt(np.linalg.pinv(-hessian)[0, 0]))
