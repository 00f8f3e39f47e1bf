"""Do two or more sets of trials share one psychometric function? Likelihood-ratio tests."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc

from analysis.psychometric.counts import Counts, counts
from analysis.psychometric.fit import Setting, fit


@dataclass(frozen=True)
class Comparison:
    """Twice the log likelihood that a shared function loses on separate ones, with df and p."""

    statistic: float
    df: int
    p: float


def pool(parts: Sequence[Counts]) -> Counts:
    """All trials together."""
    return counts(*(np.concatenate([getattr(part, name) for part in parts])
                    for name in ("levels", "correct", "total")))  # fmt: skip


def same_function(parts: Sequence[Counts], what: Setting) -> Comparison:
    """Test that location and slope (and a free lapse rate) are the same in all `parts`.

    χ² with as many degrees of freedom as the separate fits have more parameters; trials are taken
    as independent, so that with people who differ the p is a lower bound.
    """
    apart = sum(float(fit(part, what).value[0]) for part in parts)
    together = float(fit(pool(parts), what).value[0])
    df = (len(parts) - 1) * (2 + (what.lapse is None))
    statistic = max(2 * (apart - together), 0.0)
    return Comparison(statistic, df, float(chdtrc(df, statistic)))
