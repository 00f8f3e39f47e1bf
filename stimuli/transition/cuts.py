"""Hard cuts where a weight set finds them cheapest: what the weights study shows (Wang IV.4.1)."""

from math import ceil, floor

import numpy as np

from stimuli.errors import InputError
from stimuli.motion.loops import unroll
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.transition.distance import cost_matrix
from stimuli.transition.methods import Transition, transition
from stimuli.transition.points import TRIVIAL, TransitionPoint, cheapest
from stimuli.transition.room import with_room
from stimuli.transition.weights import Weights

CLIP_FRAMES = 180  # six seconds, the cut in their middle


def best_cut(
    a: Motion,
    b: Motion,
    weights: str | Weights = "wang",
    clip_frames: int = CLIP_FRAMES,
    trivial: int = TRIVIAL,
    specification: str = "start-end",
) -> tuple[Transition, TransitionPoint]:
    """`a` cut to `b` at the cheapest cell of the cost that leaves half a clip on both sides.

    A loop has that room everywhere, since it is unrolled. Where a motion is cut to itself, cells
    within `trivial` frames of going on are left out. The point counts the frames of the motions as
    given, the transition those of the unrolled ones. InputError when no cell leaves as much.
    """
    half = clip_frames // 2
    cost = _cost_of_a_cycle(a, b, weights)
    if a.same_as(b):
        cost[_goes_on(a, len(cost), trivial)] = np.inf
    point = cheapest(cost, before=0 if a.loop else half, after=0 if b.loop else half)
    if point is None:
        raise _no_room(a, b, half, _most_room(cost, a, b))
    longer_a, i = with_room(a, point.i, half)
    longer_b, j = with_room(b, point.j, half)
    cut = transition(longer_a, longer_b, i, j, method="cut", specification=specification)
    return cut, point


def _cost_of_a_cycle(a: Motion, b: Motion, weights: str | Weights) -> Array:
    """The cost between the frames of both, each frame of a loop once, its velocities across the
    seam."""
    (longer_a, from_a), (longer_b, from_b) = unroll(a, 1, 1), unroll(b, 1, 1)
    cost = cost_matrix(longer_a, longer_b, weights)
    return cost[from_a : from_a + _different(a), from_b : from_b + _different(b)]


def _different(motion: Motion) -> int:
    """Frames of which none is the first one of a loop's next cycle."""
    whole = len(motion)
    return whole if motion.cycle is None else min(whole, ceil(motion.cycle.period - 1e-9))


def _goes_on(motion: Motion, frames: int, trivial: int) -> np.ndarray:
    """Cells (F, F) at which a motion cut to itself just goes on.

    A quarter of a loop's cycle at most: half a second may be all of it.
    """
    places = np.arange(frames)
    apart = np.abs(places[:, None] - places).astype(float)
    if motion.cycle is None:
        return apart <= trivial
    period = motion.cycle.period
    return np.minimum(apart, period - apart) <= min(trivial, period / 4)


def _most_room(cost: Array, a: Motion, b: Motion) -> int:
    """The most frames that a cell of finite cost leaves on both sides; −1 when there is none."""
    before = np.full(cost.shape[0], np.inf) if a.loop else np.arange(cost.shape[0])
    after = np.full(cost.shape[1], np.inf) if b.loop else np.arange(cost.shape[1])[::-1]
    room = np.minimum(before[:, None], after)[np.isfinite(cost)]
    return int(room.max(initial=-1))


def _no_room(a: Motion, b: Motion, half: int, most: int) -> InputError:
    seconds = floor(200 * most / a.fps) / 100  # rounded down, so that what is said does fit
    shorter = f", or a clip of at most {seconds:g} seconds (--seconds)" if seconds > 0 else ""
    return InputError(
        f"cut: expected motions with {half} frames before it and after, found {len(a)} and "
        f"{len(b)} frames.\nTake longer motions{shorter}."
    )
