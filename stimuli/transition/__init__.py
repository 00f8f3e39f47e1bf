"""Transitions between motions: distance, weights, blend length, alignment, blending.

The dissertation's chapters IV to VI: how far two poses are apart, how long a blend should last,
and how the two motions are joined, in the start-end or the center-aligned specification.
"""

from stimuli.transition.distance import cost_matrix, pose_distance
from stimuli.transition.length import Length
from stimuli.transition.measures import transition_measures
from stimuli.transition.methods import (
    METHODS,
    PAIRWISE,
    Method,
    Transition,
    blend_length,
    transition,
)
from stimuli.transition.room import with_room
from stimuli.transition.route import Route
from stimuli.transition.weights import WEIGHTS
from stimuli.transition.window import LONGEST, SPECIFICATIONS, longest_fitting

__all__ = [
    "LONGEST",
    "METHODS",
    "PAIRWISE",
    "SPECIFICATIONS",
    "WEIGHTS",
    "Length",
    "Method",
    "Route",
    "Transition",
    "blend_length",
    "cost_matrix",
    "longest_fitting",
    "pose_distance",
    "transition",
    "transition_measures",
    "with_room",
]
