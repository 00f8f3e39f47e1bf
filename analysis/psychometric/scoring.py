"""Fisher scoring of many binomial likelihoods at once, within bounds.

Every sample of a bootstrap, every profile of an interval and every simulated set of a
certificate is one row of a batch: the rows climb together in array operations, which is what
makes thousands of fits cheap.
"""

from collections.abc import Callable

import numpy as np

from analysis.psychometric.functions import Array

# A model maps parameters (B, P) of the rows `which` (B,) to the proportion right (B, L), its
# complement, and the Jacobian of the proportion (B, P, L).
Model = Callable[[Array, Array], tuple[Array, Array, Array]]

TINY = 1e-300
ITERATIONS = 60
THOROUGH = 400  # for fits that are few: a ridge is climbed slowly
TOLERANCE = 1e-8  # gain in log likelihood that a step must still promise
ROUGH = 1e-5  # the same for resamples: a four-hundredth of a standard error or so


def log_likelihood(p: Array, q: Array, correct: Array, total: Array) -> Array:
    """Bernoulli log likelihood, summed over the last axis, without binomial coefficients."""
    right = correct * np.log(np.maximum(p, TINY))
    return (right + (total - correct) * np.log(np.maximum(q, TINY))).sum(-1)


def maximise(
    model: Model,
    start: Array,
    lower: Array,
    upper: Array,
    correct: Array,
    total: Array,
    tolerance: float = TOLERANCE,
    iterations: int = ITERATIONS,
) -> tuple[Array, Array]:
    """Climb from `start` (B, P) within `lower`, `upper` (P,) or (B, P).

    `correct` and `total` are (B, L). Returns parameters (B, P) and log likelihoods (B,).
    Levenberg damping per row: a step that does not gain is not taken, so that no row ever ends
    lower than it started.
    """
    rows = len(start)
    lower, upper = np.broadcast_to(lower, start.shape), np.broadcast_to(upper, start.shape)
    theta = np.clip(start, lower, upper)
    damping = np.full(rows, 1e-4)
    value = np.empty(rows)
    active = np.arange(rows)
    p, q, jacobian = model(theta, active)
    value[:] = log_likelihood(p, q, correct, total)
    for _ in range(iterations):
        k, n = correct[active], total[active]
        step, promise = _step(
            theta[active], lower[active], upper[active], p, q, jacobian, k, n, damping[active]
        )
        tried = np.clip(theta[active] + step, lower[active], upper[active])
        p_new, q_new, jacobian_new = model(tried, active)
        found = log_likelihood(p_new, q_new, k, n)
        better = found > value[active]
        theta[active[better]], value[active[better]] = tried[better], found[better]
        damping[active] = np.where(better, damping[active] * 0.2, damping[active] * 8 + 1e-6)
        keep = (promise > tolerance) & (damping[active] < 1e8)
        if not keep.any():
            break
        worse = ~better
        for new, old in ((p_new, p), (q_new, q), (jacobian_new, jacobian)):
            new[worse] = old[worse]
        p, q, jacobian = (
            (p_new, q_new, jacobian_new)
            if keep.all()
            else (p_new[keep], q_new[keep], jacobian_new[keep])
        )
        active = active[keep]
    return theta, value


def _step(
    theta: Array, lower: Array, upper: Array, p: Array, q: Array, jacobian: Array,
    correct: Array, total: Array, damping: Array,
) -> tuple[Array, Array]:  # fmt: skip
    """The damped scoring step (B, P) and the gain (B,) that it promises."""
    spread = np.maximum(p * q, TINY)
    gradient = (jacobian @ ((correct - total * p) / spread)[:, :, None])[:, :, 0]
    information = (jacobian * (total / spread)[:, None]) @ jacobian.swapaxes(1, 2)
    # A parameter at its bound that wants to go beyond stays out of the step.
    held = ((theta <= lower) & (gradient < 0)) | ((theta >= upper) & (gradient > 0))
    gradient = np.where(held, 0.0, gradient)
    free = ~held
    information = np.where(free[:, :, None] & free[:, None, :], information, 0.0)
    diagonal = np.einsum("bpp->bp", information)
    size = theta.shape[1]
    ridge = damping[:, None] * np.maximum(diagonal, 1e-12) + 1e-12 + held
    information = information + ridge[:, :, None] * np.eye(size)
    step = np.linalg.solve(information, gradient[:, :, None])[:, :, 0]
    return step, (gradient * step).sum(-1)
