"""All people at once: one function whose threshold differs from person to person.

Personal thresholds are normal around a common mean (on a logarithmic scale for the Weibull
function); slope and lapse rate are shared. The likelihood is integrated over the thresholds by
Gauss-Hermite quadrature, so that a person's few trials count for what they say and no more.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize
from scipy.special import chdtri

from analysis.psychometric.bootstrap import PeopleCounts
from analysis.psychometric.fit import Setting, fit, scale_of
from analysis.psychometric.functions import Array
from analysis.psychometric.scoring import TINY

_NODES = 21
_LARGEST_SD = 4.0  # of thresholds, in half ranges of the levels
_CLOSE = 2e-3  # half ranges to which an end is found
STEPS = 30
_FARTHEST = 8.0  # an end farther than this many half ranges from the mean is unbounded


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
    root = float(np.sqrt(chdtri(1, 1 - level)))
    ends = [model.end(theta, top, root, sign) for sign in (-1.0, 1.0)]
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
        nodes, weights = np.polynomial.hermite_e.hermegauss(_NODES)
        self.nodes, self.log_weights = nodes, np.log(weights / weights.sum())
        top = min(what.lapse_bound, 1 - at - 1e-3)
        self.bounds = [
            (-_FARTHEST, _FARTHEST),
            (1e-3, _LARGEST_SD),
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

    def end(self, theta: Array, top: float, root: float, sign: float) -> float:
        """Where the signed root of the likelihood ratio reaches `root` on one side of the mean.

        ±inf where it does not. The root is nearly straight in the mean, so few steps find it; each
        starts from the last one's slope, spread and lapse rate.
        """
        last = theta

        def excess(distance: float) -> float:
            nonlocal last
            last, value = self.maximise(last, float(theta[0] + sign * distance))
            return float(np.sqrt(max(2 * (top - value), 0.0))) - root

        inside, at_inside, distance = 0.0, -root, 0.1
        while distance <= _FARTHEST:
            found = excess(distance)
            if found > 0:
                bracket = (inside, at_inside), (distance, found)
                return float(theta[0] + sign * _false_position(excess, *bracket))
            inside, at_inside, distance = distance, found, distance * 2
        return sign * float("inf")


def _false_position(
    function: Callable[[float], float], below: tuple[float, float], above: tuple[float, float]
) -> float:
    """The root between `below` and `above`, pairs of a place and the value there, to _CLOSE."""
    (low, at_low), (high, at_high) = below, above
    place = high
    for _ in range(STEPS):
        last, place = place, high - at_high * (high - low) / (at_high - at_low)
        if abs(place - last) < _CLOSE:
            break
        found = function(place)
        if found < 0:
            low, at_low, at_high = place, found, at_high / 2
        else:
            high, at_high, at_low = place, found, at_low / 2
    return place
