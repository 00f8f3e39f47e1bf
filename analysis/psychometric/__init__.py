"""Psychometric functions: their table, maximum-likelihood fits, intervals and the verdict.

NumPy and SciPy only and cheap to import, since the simulated observers of `study` share it.
"""

from analysis.psychometric.bootstrap import PeopleCounts, people_counts
from analysis.psychometric.counts import Counts, counts
from analysis.psychometric.fit import Setting, fit, fit_batch, setting
from analysis.psychometric.functions import (
    FUNCTIONS,
    Function,
    level_at,
    location_for,
    proportion,
)
from analysis.psychometric.summary import Summary, Threshold, summarise, summarise_each

__all__ = [
    "FUNCTIONS",
    "Counts",
    "Function",
    "PeopleCounts",
    "Setting",
    "Summary",
    "Threshold",
    "counts",
    "fit",
    "fit_batch",
    "level_at",
    "location_for",
    "people_counts",
    "proportion",
    "setting",
    "summarise",
    "summarise_each",
]
