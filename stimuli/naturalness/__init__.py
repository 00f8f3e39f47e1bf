"""How natural a motion is, without asking anybody: feet, balance, flight, and a statistical rival.

Ikemoto, Arikan and Forsyth (2007), sections 6 and 7. `segments` has the body as point masses,
`dynamics` how they move, `support` what bears them, `planted` where feet should stand, `masses` the
masses of a performer, `score` the errors.
"""

from stimuli.naturalness.masses import fitted_masses
from stimuli.naturalness.planted import Footplant, Source, carried_plants, own_plants
from stimuli.naturalness.score import Course, Naturalness, score_motion
from stimuli.naturalness.segments import BODY_PARTS, WINTER, segment_centres

__all__ = [
    "BODY_PARTS",
    "WINTER",
    "Course",
    "Footplant",
    "Naturalness",
    "Source",
    "carried_plants",
    "fitted_masses",
    "own_plants",
    "score_motion",
    "segment_centres",
]
