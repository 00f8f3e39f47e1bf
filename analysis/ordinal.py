"""Ordinal regression of ratings: the test that takes a five-point scale for what it is."""

import warnings
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.special import ndtr, ndtri

from analysis.psychometric.functions import Array


@dataclass(frozen=True)
class Ordinal:
    """The log odds of a higher rating under the second method; None where it cannot be fitted."""

    estimate: float | None
    low: float | None
    high: float | None
    z: float | None
    p: float | None
    why_not: str = ""


def ordinal(ratings: Array, method: Array, order: Array, people: Array) -> Ordinal:
    """Proportional-odds model (statsmodels' OrderedModel) of ratings (N,) by method and order.

    `method` and `order` are −1 or 1; standard errors are those of a sandwich clustered by
    person, since each person rates both methods.
    """
    from statsmodels.miscmodels.ordinal_model import OrderedModel

    if _alike(ratings, method, people):
        return Ordinal(None, None, None, None, None, "nobody rated the two methods differently")
    if len(np.unique(ratings)) < 2:
        return Ordinal(None, None, None, None, None, "every rating is the same")
    columns = {"method": method / 2}
    if len(np.unique(order)) > 1:
        columns["order"] = order / 2
    exog = pd.DataFrame(columns)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            model = OrderedModel(pd.Series(ratings), exog, distr="logit")
            fit = model.fit(method="bfgs", disp=False, maxiter=500)
            bread = np.linalg.inv(-model.hessian(fit.params))
            scores = model.score_obs(fit.params)
        except (np.linalg.LinAlgError, ValueError) as error:
            return Ordinal(None, None, None, None, None, f"the model cannot be fitted ({error})")
    estimate = float(fit.params.iloc[0])
    variance = float(_sandwich(bread, np.asarray(scores), people)[0, 0])
    if not np.isfinite(variance) or variance <= 0 or abs(estimate) > 15:
        return Ordinal(None, None, None, None, None, "the methods' ratings do not overlap")
    spread, reach = float(np.sqrt(variance)), float(ndtri(0.975))
    z = estimate / spread
    return Ordinal(
        estimate,
        float(estimate - reach * spread),
        float(estimate + reach * spread),
        float(z),
        float(2 * ndtr(-abs(z))),
    )


def _alike(ratings: Array, method: Array, people: Array) -> bool:
    """Whether each person gave both methods the same rating."""
    order = np.lexsort((method, people))
    pairs = ratings[order].reshape(-1, 2)
    return bool(np.allclose(pairs[:, 0], pairs[:, 1], rtol=0, atol=1e-9))


def _sandwich(bread: Array, scores: Array, people: Array) -> Array:
    """Cluster-robust covariance with the usual G/(G − 1) correction."""
    groups, person = np.unique(people, return_inverse=True)
    sums = np.zeros((len(groups), scores.shape[1]))
    np.add.at(sums, person, scores)
    correction = len(groups) / max(len(groups) - 1, 1)
    return correction * bread @ (sums.T @ sums) @ bread
