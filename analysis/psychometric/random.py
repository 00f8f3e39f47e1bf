"""All people at once: one function whose threshold differs from person to person.

Personal thresholds are normal around a common mean (on a logarithmic scale for the Weibull
function); slope and lapse rate are shared. The likelihood is integrated over the thresholds by
Gauss-Hermite quadrature, so that a person's few trials count for what they say and no more.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize, root_scalar
from scipy.special import chdtri

from analysis.psychometric.bootstrap import PeopleCounts
from analysis.psychometric.fit import MAXIMUM_LAPSE, Setting, fit, scale_of
from analysis.psychometric.functions import Array
from analysis.psychometric.scoring import TINY

NODES = 21
LARGEST_SD = 4.0  # of thresholds, in half ranges of the levels
FARTHEST = 8.0  # an end farther than this many half ranges from the mean is unbounded


@dataclass(frozen=True)
class RandomThreshold:
    """Mean threshold at `at` with its profile interval, and the SD of personal thresholds."""

    at: float
    value: float
    low: float
    high: float
    sd: float
    slope: float
    lapse: float
    log_likelihood: float
    method: str = "maximum marginal likelihood, random threshold, profile interval"


def fit_random_threshold(
    data: PeopleCounts, what: Setting, at: float = 0.75, level: float = 0.95
) -> RandomThreshold:
    """Fit people's thresholds as a normal distribution; `sd` is on the transformed scale."""
    model = _Model(data, what, at)
    pooled = fit(data.pooled(), what)
    start = float(pooled.threshold(at)[0])
    start = (float(what.function.transform(np.array(start))) - model.centre) / model.half
    start = float(np.clip(start if np.isfinite(start) else 0.0, -1, 1))
    steep = float(np.clip(pooled.b[0], 0.5, model.steepest / 2))
    starts = [
        np.array([start, sd, np.log(steep * more), 0.02]) for sd, more in ((0.05, 1.0), (0.3, 1.5))
    ]
    best = max((model.maximise(s) for s in starts), key=lambda found: found[1])
    theta, top = best
    floor = top - chdtri(1, 1 - level) / 2
    ends = [model.end(theta, floor, sign) for sign in (-1.0, 1.0)]
    low, high = (
        float(what.function.untransform(model.centre + model.half * np.array(end))) for end in ends
    )
    middle = what.function.untransform(model.centre + model.half * np.array(theta[0]))
    return RandomThreshold(
        at, float(middle), low, high, float(theta[1] * model.half),
        float(np.exp(theta[2]) / (model.half * what.function.scale)),
        what.lapse if what.lapse is not None else float(theta[3]), float(top),
    )  # fmt: skip


class _Model:
    """The marginal likelihood of (mean, sd, log slope, lapse), thresholds in half ranges."""

    def __init__(self, data: PeopleCounts, what: Setting, at: float) -> None:
        scale = scale_of(data.levels, what.function)
        self.z, self.centre, self.half = scale.z, scale.centre, scale.half
        self.steepest = scale.steepest
        self.right, self.wrong = data.correct, data.total - data.correct
        self.what, self.at = what, at
        nodes, weights = np.polynomial.hermite_e.hermegauss(NODES)
        self.nodes, self.log_weights = nodes, np.log(weights / weights.sum())
        top = min(MAXIMUM_LAPSE, 1 - at - 1e-3)
        self.bounds = [
            (-FARTHEST, FARTHEST),
            (1e-3, LARGEST_SD),
            (np.log(0.2), np.log(self.steepest)),
            (0.0, top),
        ]

    def value(self, theta: Array) -> float:
        """Log marginal likelihood at (mean, sd, log slope, lapse)."""
        mean, sd, log_b, free = theta
        lapse = free if self.what.lapse is None else self.what.lapse
        span = 1 - self.what.guess - lapse
        shape = self.what.function
        offset = shape.inverse(np.array((self.at - self.what.guess) / span))
        threshold = mean + sd * self.nodes[:, None]
        eta = np.exp(log_b) * (self.z - threshold) + offset
        log_p = np.log(np.maximum(self.what.guess + span * shape.cdf(eta), TINY))
        log_q = np.log(np.maximum(lapse + span * shape.survival(eta), TINY))
        each = self.right @ log_p.T + self.wrong @ log_q.T
        each = each + self.log_weights
        top = each.max(1)
        return float((top + np.log(np.exp(each - top[:, None]).sum(1))).sum())

    def maximise(self, start: Array, mean: float | None = None) -> tuple[Array, float]:
        """Climb from `start`, the mean held when given."""
        bounds = list(self.bounds)
        if self.what.lapse is not None:
            bounds[3] = (self.what.lapse, self.what.lapse)
        if mean is not None:
            bounds[0] = (mean, mean)
        clipped = np.array([np.clip(s, *b) for s, b in zip(start, bounds, strict=True)])
        found = minimize(lambda t: -self.value(t), clipped, method="L-BFGS-B", bounds=bounds)
        return found.x, -float(found.fun)

    def end(self, theta: Array, floor: float, sign: float) -> float:
        """Where the profile of the mean falls to `floor` on one side; ±inf if it does not."""

        def excess(distance: float) -> float:
            return self.maximise(theta, float(theta[0] + sign * distance))[1] - floor

        inside, distance = 0.0, 0.1
        while distance <= FARTHEST:
            if excess(distance) < 0:
                root = root_scalar(excess, bracket=(inside, distance), xtol=1e-4)
                return float(theta[0] + sign * root.root)
            inside, distance = distance, distance * 2
        return sign * float("inf")
