"""The bias-reduced fit: maximum likelihood with Jeffreys' prior as a penalty.

Few trials, and adaptive ones more so, make maximum likelihood too steep. The penalty, half the
log determinant of the expected information, is Firth's (1993); with a guess rate it reduces the
bias of the slope rather than removing it, and it keeps estimates finite where the data separate
(Kosmidis and Firth 2021).
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from analysis.psychometric.counts import Counts
from analysis.psychometric.fit import SHALLOWEST, Batch, Setting, curve, fit
from analysis.psychometric.functions import Array
from analysis.psychometric.scoring import log_likelihood


@dataclass(frozen=True, eq=False)
class Reduced:
    """The penalised estimates; `batch` gives thresholds like any other fit."""

    location: float
    slope: float
    batch: Batch

    def threshold(self, at: float) -> float:
        return float(self.batch.threshold(at)[0])


def fit_reduced(data: Counts, what: Setting) -> Reduced:
    """Fit location and slope with the penalty; a free lapse rate stays at its likeliest."""
    plain = fit(data, what)
    fixed = Setting(what.function, what.guess, float(plain.lapse[0]))
    scale, correct, total = plain.scale, data.correct[None], data.total[None]

    def loss(theta: Array) -> float:
        point = np.array([[theta[0], np.exp(theta[1])]])
        p, q, jacobian = curve(scale.z, point, fixed)
        weight = total[0] / np.maximum(p * q, 1e-12)[0]
        information = (jacobian[0] * weight) @ jacobian[0].T
        sign, size = np.linalg.slogdet(information)
        penalty = 0.5 * size if sign > 0 else -50.0
        return -float(log_likelihood(p, q, correct, total)[0]) - penalty

    steep = min(max(float(plain.b[0]), 0.2), scale.steepest / 4)
    start = np.array(
        [float(plain.a[0]) * steep / max(float(plain.b[0]), SHALLOWEST), np.log(steep)]
    )
    found = minimize(
        loss, start, method="Nelder-Mead", options={"xatol": 1e-6, "fatol": 1e-8, "maxiter": 600}
    )
    a, b = float(found.x[0]), float(np.exp(found.x[1]))
    batch = Batch(fixed, scale, np.array([a]), np.array([b]), plain.lapse, -np.array([found.fun]))
    return Reduced(float(batch.location[0]), float(batch.slope[0]), batch)
