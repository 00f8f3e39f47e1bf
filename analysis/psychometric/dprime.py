"""Proportions right and d′, under the two decision rules that odd-pair answers allow.

`two-interval`: the pair that looks more different is one observation against another,
`p = Φ(d′/√2)` (Green and Swets 1966). `dual-pair`: each pair is judged by the difference of its own
two clips and the larger difference, either way, is chosen: `p = Φ(d′/2)² + Φ(−d′/2)²` (Rousseau
and Ennis 2001), with d′ between two clips; the same proportion then means a larger d′.
"""

from collections.abc import Callable

import numpy as np
from scipy.special import ndtr, ndtri

from analysis.errors import InputError

_ROOT_TWO = float(np.sqrt(2))


def _two_interval(d_prime: float) -> float:
    return float(ndtr(d_prime / _ROOT_TWO))


def _two_interval_inverse(p: float) -> float:
    return float(_ROOT_TWO * ndtri(p))


def _dual_pair(d_prime: float) -> float:
    return float(ndtr(d_prime / 2) ** 2 + ndtr(-d_prime / 2) ** 2)


def _dual_pair_inverse(p: float) -> float:
    # With x = Φ(d′/2): x² + (1 − x)² = p, so x = (1 + √(2p − 1)) / 2.
    return float(2 * ndtri((1 + np.sqrt(2 * p - 1)) / 2))


DECISION_RULES: dict[str, tuple[Callable[[float], float], Callable[[float], float]]] = {
    "two-interval": (_two_interval, _two_interval_inverse),
    "dual-pair": (_dual_pair, _dual_pair_inverse),
}


def proportion_of(d_prime: float, rule: str = "two-interval") -> float:
    """Proportion right of an unbiased observer with sensitivity d′ ≥ 0."""
    if not d_prime > 0 or rule not in DECISION_RULES:
        raise InputError(
            f"d′: expected a number above 0 and a rule of {', '.join(DECISION_RULES)}, "
            f"found {d_prime:g} and {rule!r}"
        )
    return DECISION_RULES[rule][0](d_prime)


def d_prime_of(p: float, rule: str = "two-interval") -> float:
    """Sensitivity behind a proportion right between ½ and 1."""
    if not 0.5 <= p < 1 or rule not in DECISION_RULES:
        raise InputError(
            f"proportion right: expected at least ½ and below 1 and a rule of "
            f"{', '.join(DECISION_RULES)}, found {p:g} and {rule!r}"
        )
    return DECISION_RULES[rule][1](p)
