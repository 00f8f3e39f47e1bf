"""Psychometric functions: their table, maximum-likelihood fits, intervals and the verdict.

NumPy and SciPy only and cheap to import, since the simulated observers of `study` share it.
"""

from analysis.psychometric.functions import (
    FUNCTIONS,
    Function,
    level_at,
    location_for,
    proportion,
)

__all__ = ["FUNCTIONS", "Function", "level_at", "location_for", "proportion"]
