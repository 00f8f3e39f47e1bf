"""Transition points of start-end studies, drawn by a seed under stated conditions.

The cheapest point of the pose cost is no place for a start-end transition: there the best blend
length is nearly always one frame. The dissertation drew its points at random (Wang VI.4); so do we,
among the frames that leave room for the clip, until a study's own condition holds.
"""

from collections.abc import Callable, Mapping

import numpy as np

from stimuli.errors import InputError
from stimuli.motion.skeleton import Motion
from stimuli.transition.length import FIXED, Length
from stimuli.transition.methods import blend_length
from stimuli.transition.room import with_room
from stimuli.transition.window import LONGEST

TRIES = 5000
LengthBy = Callable[[str], Length]  # the start-end length at a point, by the name of a method
Condition = Callable[[LengthBy], bool]


def away_from_fixed(length: LengthBy) -> bool:
    """Wang V.2, study one: 5 to 35 frames, and not close to the fixed ten."""
    frames = length("geodesic").frames
    return 5 <= frames <= 35 and abs(frames - FIXED) > 2


def velocity_away_from_fixed(length: LengthBy) -> bool:
    """Study two: the velocity method's length is no clamp and not close to the fixed ten."""
    frames = length("velocity").frames
    return 3 <= frames <= 35 and abs(frames - FIXED) > 2


def time_is_warped(length: LengthBy) -> bool:
    """Study three: as one, and the timewarp, of 35 frames at most, stretches by three or more.

    Often it stretches nothing: then both methods make one and the same clip.
    """
    if not away_from_fixed(length):
        return False
    warped = length("timewarp")
    windows = warped.report["from_frames"], warped.report["to_frames"]
    return warped.frames <= 35 and abs(windows[0] - windows[1]) >= 3


def methods_differ(length: LengthBy) -> bool:
    """Study four: the two methods give lengths that can be told apart."""
    both = length("geodesic").frames, length("velocity").frames
    return all(3 <= frames <= 35 for frames in both) and abs(both[0] - both[1]) > 4


def near_the_dissertations(length: LengthBy) -> bool:
    """VI.3.2: a reference length like his 9, 15 and 16, with room for shorter ones."""
    return 9 <= length("geodesic").frames <= 20


POINT_CONDITIONS: Mapping[str, Condition] = {
    "study-one": away_from_fixed,
    "study-two": velocity_away_from_fixed,
    "study-three": time_is_warped,
    "study-four": methods_differ,
    "jnd-start-end": near_the_dissertations,
}


def draw_point(
    a: Motion,
    b: Motion,
    condition: Condition,
    generator: np.random.Generator,
    clip_frames: int = 180,
    tries: int = TRIES,
) -> tuple[int, int]:
    """Frames (i, j) of a start-end transition from `a` to `b`, drawn evenly.

    Half a clip lies before i and half after j (loops have it always), and the longest blend fits
    on both sides. Raises InputError when no point of `tries` meets the condition.
    """
    half = clip_frames // 2
    first_i, last_i = (0, len(a) - 2) if a.loop else (half, len(a) - LONGEST)
    first_j, last_j = (0, len(b) - 2) if b.loop else (LONGEST - 1, len(b) - 1 - half)
    if last_i < first_i or last_j < first_j:
        raise InputError(
            f"expected motions of {half + LONGEST} frames or more to draw a transition from, "
            f"found {len(a)} and {len(b)}; take longer ones"
        )
    for _ in range(tries):
        i = int(generator.integers(first_i, last_i + 1))
        j = int(generator.integers(first_j, last_j + 1))
        if condition(length_at(a, b, i, j)):
            return i, j
    raise InputError(
        f"expected a transition point that meets {condition.__name__}, found none in {tries} "
        "draws; take other motions"
    )


def length_at(a: Motion, b: Motion, i: int, j: int) -> LengthBy:
    """The start-end blend length at (i, j), for any method that is asked for."""
    longer_a, at_i = with_room(a, i)
    longer_b, at_j = with_room(b, j)
    return lambda method: blend_length(longer_a, longer_b, at_i, at_j, method, "start-end")
