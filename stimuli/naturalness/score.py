"""How natural a motion is: by its feet, its balance, and what it does in flight.

Ikemoto, Arikan and Forsyth (2007, section 7): the score is the sum of the plant error and of the
error of the zero moment point, both in metres; less is more natural.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stimuli.errors import InputError
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.naturalness.dynamics import (
    BORNE,
    angular_momentum,
    in_motion,
    well_derived,
    zero_moment_points,
)
from stimuli.naturalness.planted import Footplant, own_plants, slid_by, stands_by
from stimuli.naturalness.segments import WINTER, segment_centres
from stimuli.naturalness.support import beyond_support, support_of
from stimuli.transition.plants import spans

SHORTEST_FLIGHT = 4  # frames: of fewer no change of momentum can be told
_LEAST = 4  # frames of a motion
NO_PLANT = "no foot stands in it: nothing tells a slide, and there is no score"
NO_SUPPORT = "no foot bears the weight in it: there is no zero moment point, and no score"


@dataclass(frozen=True, eq=False)
class Course:
    """A motion frame by frame.

    `slide` (F, 2): metres that either foot is off where it should stand, NaN where it should not;
    `point` (F, 2): the zero moment point, x and z; `beyond` (F,): metres from it to the support,
    NaN where no foot stands and near the ends, where no acceleration is known; `borne` (F,): the
    share of the weight that the ground bears; `momentum` (F, 3): angular, by the body's mass,
    square metres a second; `flight` (F,): whether no foot bears the body.
    """

    slide: Array
    point: Array
    beyond: Array
    borne: Array
    momentum: Array
    flight: np.ndarray


@dataclass(frozen=True, eq=False)
class Naturalness:
    """Errors of a motion, None where there is nothing to tell them by.

    `plant`: metres, the mean over frames in which a foot should stand; `zmp`: metres, the largest
    of supported frames; `score`: their sum; `ballistic`: the largest change of angular momentum
    within a flight, square metres a second; `supported` and `flight` count frames.
    """

    plant: float | None
    zmp: float | None
    ballistic: float | None
    score: float | None
    plants: int
    supported: int
    flight: int
    frames: int
    remark: str
    course: Course

    def as_dict(self) -> dict[str, float | int | str | None]:
        """What goes into a manifest, and is printed."""
        found = {
            "plant_error": self.plant,
            "zmp_error": self.zmp,
            "ballistic_error": self.ballistic,
            "naturalness": self.score,
        }
        return {
            **{name: None if value is None else round(value, 6) for name, value in found.items()},
            "plants": self.plants,
            "supported_frames": self.supported,
            "flight_frames": self.flight,
        }


def score_motion(
    motion: Motion, plants: Sequence[Footplant] | None = None, masses: Array = WINTER
) -> Naturalness:
    """The errors of a motion.

    `plants` are where its feet should stand, as its sources tell (`carried_plants`); without them
    its own. `masses` (S,) are those of `BODY_PARTS`. InputError for a skeleton without the roles
    that `segment_centres` needs, and for fewer than four frames.
    """
    if len(motion) < _LEAST:
        raise InputError(
            f"score: expected {_LEAST} frames or more, found {len(motion)}; "
            "of fewer nothing tells an acceleration."
        )
    plants = own_plants(motion) if plants is None else plants
    course = _course(motion, plants, masses)
    off = course.slide[np.isfinite(course.slide)]
    held = np.isfinite(course.beyond)
    plant = float(off.mean()) if len(off) else None
    zmp = float(course.beyond[held].max()) if held.any() else None
    return Naturalness(
        plant=plant,
        zmp=zmp,
        ballistic=_ballistic(course),
        score=None if plant is None or zmp is None else plant + zmp,
        plants=len(plants),
        supported=int(held.sum()),
        flight=int(course.flight.sum()),
        frames=len(motion),
        remark=NO_PLANT if plant is None else NO_SUPPORT if zmp is None else "",
        course=course,
    )


def _course(motion: Motion, plants: Sequence[Footplant], masses: Array) -> Course:
    support = support_of(motion, stands_by(plants, len(motion)))
    moving = in_motion(segment_centres(motion), motion.fps)
    point, borne = zero_moment_points(moving, masses, support.floor)
    beyond = beyond_support(point, support)
    told = support.stands.any(axis=1) & (borne > BORNE) & well_derived(len(motion), motion.fps)
    return Course(
        slide=slid_by(motion, plants),
        point=point,
        beyond=np.where(told, beyond, np.nan),
        borne=borne,
        momentum=angular_momentum(moving, masses),
        flight=np.logical_not(support.bears.any(axis=(1, 2))),
    )


def _ballistic(course: Course) -> float | None:
    """The largest distance of angular momentum from its mean within a flight."""
    off = [
        float(np.linalg.norm(part - part.mean(axis=0), axis=1).max())
        for first, last in spans(course.flight)
        if last - first + 1 >= SHORTEST_FLIGHT
        for part in [course.momentum[first : last + 1]]
    ]
    return max(off) if off else None
