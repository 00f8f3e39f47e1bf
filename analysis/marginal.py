"""Marginal likelihoods of choices whose log odds vary from person to person and motion to motion.

The log odds of cell (i, j) are `β + s₁·u_i + s₂·v_j` with u and v standard normal. Two groupings
that cross leave an integral over all of u and v at once, which Laplace's approximation at the mode
gives (as lme4 does); of one grouping each group has an integral of its own, which adaptive
Gauss-Hermite quadrature gives nearly exactly. Both come with analytic gradients: differences of a
value that an inner loop found would magnify whatever that loop left.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.special import expit, roots_hermite

from analysis.psychometric.functions import Array

NODES = 61  # of the quadrature: a few hundred answers of one person bend it far from normal
_CLOSE = 1e-12  # squared length of an inner Newton step, in the metric of its own curvature
INNER = 100
HALVINGS = 40
FINER = (141, 281)  # nodes for groups so alike that fewer still change the result


@dataclass(frozen=True, eq=False)
class Cells:
    """Choices by two groupings: `chose` of `total` answers in each cell (G, H)."""

    chose: Array
    total: Array

    def along(self, axis: int) -> "Cells":
        """The groups of `axis` alone, (G, 1): all that one grouping's likelihood needs."""
        return Cells(*(t.sum(1 - axis)[:, None] for t in (self.chose, self.total)))


def _joint(eta: Array, u: Array, cells: Cells) -> float:
    """Log likelihood of the answers and of the standard normal effects, without constants."""
    return float((cells.chose * eta - cells.total * np.logaddexp(0.0, eta)).sum() - 0.5 * u @ u)


class Crossed:
    """Laplace's approximation for two crossed groupings, at θ = (β, s₁, s₂).

    The mode of the last call starts the next: the outer search moves little at a time.
    """

    def __init__(self, cells: Cells) -> None:
        self.cells = cells
        self.size = cells.total.shape
        self.mode = np.zeros(sum(self.size))

    def __call__(self, theta: Array) -> tuple[float, Array]:
        """The log likelihood and its gradient (3,)."""
        scale = np.repeat(theta[1:], self.size)
        u, eta, moments, value = self._climb(theta[0], scale)
        self.mode = u
        p = expit(eta)
        slope = self.cells.chose - self.cells.total * p
        weight = self.cells.total * p * (1 - p)
        inverse = np.linalg.inv(np.eye(len(u)) + scale[:, None] * moments * scale)
        value += 0.5 * float(np.linalg.slogdet(inverse)[1])
        return value, self._gradient(u, scale, slope, weight, moments, inverse, p)

    def _climb(self, beta: float, scale: Array) -> tuple[Array, Array, Array, float]:
        """The mode of the effects by Newton steps, halved until they gain."""
        u = self.mode
        eta = self._eta(beta, scale * u)
        value = _joint(eta, u, self.cells)
        for _ in range(INNER):
            p = expit(eta)
            slope = self.cells.chose - self.cells.total * p
            moments = self._moments(self.cells.total * p * (1 - p))
            gradient = scale * self._sums(slope) - u
            step = np.linalg.solve(np.eye(len(u)) + scale[:, None] * moments * scale, gradient)
            promise, share = float(gradient @ step), 1.0
            for _ in range(HALVINGS):
                tried = u + share * step
                eta_tried = self._eta(beta, scale * tried)
                found = _joint(eta_tried, tried, self.cells)
                if found >= value or promise < _CLOSE:
                    break
                share /= 2
            u, eta, value = tried, eta_tried, found
            if promise < _CLOSE:
                break
        p = expit(eta)
        return u, eta, self._moments(self.cells.total * p * (1 - p)), value

    def _gradient(
        self, u: Array, scale: Array, slope: Array, weight: Array, moments: Array,
        inverse: Array, p: Array,
    ) -> Array:  # fmt: skip
        """The explicit part, and half the trace of H⁻¹ times how H moves with θ and the mode."""
        first = self.size[0]
        spread = scale[:, None] * inverse * scale
        # The variance of each cell's log odds given the answers.
        variance = (
            np.diag(spread)[:first, None]
            + np.diag(spread)[None, first:]
            + 2 * spread[:first, first:]
        )
        skew = weight * (1 - 2 * p) * variance
        trace = 2 * np.einsum("ij,ji->i", inverse * scale, moments)
        sums = self._sums(slope)
        parts = []
        for place in range(3):
            own = np.zeros(len(u))
            if place:
                own[slice(0, first) if place == 1 else slice(first, None)] = 1.0
            direct = np.ones(self.size) if place == 0 else self._eta(0.0, own * u)
            moved = inverse @ (own * sums - scale * self._sums(weight * direct))
            by_mode = direct + self._eta(0.0, scale * moved)
            curvature = float((skew * by_mode).sum() + own @ trace)
            parts.append(float((slope * direct).sum()) - 0.5 * curvature)
        return np.array(parts)

    def _eta(self, beta: float, effect: Array) -> Array:
        first = self.size[0]
        return beta + effect[:first, None] + effect[None, first:]

    def _sums(self, table: Array) -> Array:
        return np.concatenate([table.sum(1), table.sum(0)])

    def _moments(self, weight: Array) -> Array:
        top = np.concatenate([np.diag(weight.sum(1)), weight], 1)
        bottom = np.concatenate([weight.T, np.diag(weight.sum(0))], 1)
        return np.concatenate([top, bottom])


@lru_cache
def _rule(nodes: int) -> tuple[Array, Array]:
    """Gauss-Hermite nodes and the logs of their weights times e to their squares."""
    x, weights = roots_hermite(nodes)
    kept = weights > 0  # the outermost of many underflow
    return x[kept], np.log(weights[kept]) + x[kept] ** 2


class Grouped:
    """Adaptive Gauss-Hermite quadrature for one grouping (G, 1), at θ = (β, s)."""

    def __init__(self, cells: Cells, nodes: int = NODES) -> None:
        self.cells = cells
        self.x, self.log_weights = _rule(nodes)

    def __call__(self, theta: Array) -> tuple[float, Array]:
        """The log likelihood and its gradient (2,): the mean of the score over the effects."""
        value, _, _, first, weight = self._nodes(theta)
        return value, np.einsum("gk,tgk->t", weight, first)

    def curvature(self, theta: Array) -> Array:
        """Second derivatives (2, 2): mean of those of the answers, and the score's covariance."""
        _, u, spread, first, weight = self._nodes(theta)
        design = np.stack([np.ones_like(u), u])
        inner = -np.einsum("gk,gk,tgk,sgk->ts", weight, spread, design, design)
        mean = np.einsum("gk,tgk->tg", weight, first)
        return inner + np.einsum("gk,tgk,sgk->ts", weight, first, first) - mean @ mean.T

    def _nodes(self, theta: Array) -> tuple[float, Array, Array, Array, Array]:
        """Value, nodes, binomial variances and scores there, and posterior weights (G, K)."""
        beta, sd = theta
        chose, total = self.cells.chose, self.cells.total
        mode, width = self._modes(beta, sd)
        u = mode + np.sqrt(2.0) * width * self.x
        eta = beta + sd * u
        joint = chose * eta - total * np.logaddexp(0.0, eta) - 0.5 * u * u + self.log_weights
        top = joint.max(1, keepdims=True)
        mass = np.exp(joint - top)
        whole = mass.sum(1, keepdims=True)
        value = float((top + np.log(whole * width / np.sqrt(np.pi))).sum())
        p = expit(eta)
        slope = chose - total * p
        return value, u, total * p * (1 - p), np.stack([slope, slope * u]), mass / whole

    def _modes(self, beta: float, sd: float) -> tuple[Array, Array]:
        """Each group's mode and the width of the normal that fits there: (G, 1)."""
        chose, total = self.cells.chose, self.cells.total
        # The gradient falls from one end of this bracket to the other, whatever the counts.
        low, high = sd * (chose - total), sd * chose
        u = np.clip(np.zeros_like(chose), low, high)
        for _ in range(INNER):
            p = expit(beta + sd * u)
            gradient = sd * (chose - total * p) - u
            low, high = np.where(gradient > 0, u, low), np.where(gradient > 0, high, u)
            bend = 1 + sd * sd * total * p * (1 - p)
            step = gradient / bend
            if float((gradient * step).max()) < _CLOSE:
                u = u + step
                break
            tried = u + step
            u = np.where((tried >= low) & (tried <= high), tried, (low + high) / 2)
        p = expit(beta + sd * u)
        return u, 1 / np.sqrt(1 + sd * sd * total * p * (1 - p))
