"""Choosing the least where costs are equal but for rounding, which is another on every processor.

Costs are squares of half-angle radians and metres, from products that are exact to about 1e-15.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

ROUNDING = 1e-12  # half-angle radians² and metres²: costs that differ by less are equal


def first_least(costs: npt.ArrayLike, rounding: float = ROUNDING) -> int:
    """Place of the least of some costs (flattened), the first of equals; NaN is none.

    ValueError where there is none.
    """
    values = np.asarray(costs, dtype=float).ravel()
    return int(np.argmax(values <= values[np.nanargmin(values)] + rounding))


def ranks(
    costs: Sequence[float] | npt.NDArray[np.floating], rounding: float = ROUNDING
) -> list[int]:
    """The place of each cost's level from the least on; costs that rounding tells apart share one.

    A level reaches as far as its least cost and `rounding` do, so that no chain of near costs makes
    one of all.
    """
    found, level, start = [0] * len(costs), -1, -np.inf
    for place in np.argsort(np.asarray(costs), kind="stable"):
        if costs[place] > start + rounding or level < 0:
            level, start = level + 1, float(costs[place])
        found[place] = level
    return found
