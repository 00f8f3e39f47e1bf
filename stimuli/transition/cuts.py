"""Hard cuts where a weight set finds them cheapest: what the weights study shows (Wang IV.4.1)."""

from collections.abc import Mapping, Sequence

from stimuli.errors import InputError
from stimuli.motion.skeleton import Motion
from stimuli.transition.distance import cost_matrix
from stimuli.transition.methods import Transition, transition
from stimuli.transition.points import TRIVIAL, cheapest
from stimuli.transition.weights import Weights

CLIP_FRAMES = 180  # six seconds, the cut in their middle


def best_cut(
    a: Motion,
    b: Motion,
    weights: str | Weights,
    clip_frames: int = CLIP_FRAMES,
    trivial: int = TRIVIAL,
) -> Transition:
    """`a` cut to `b` at the cheapest cell of the cost that leaves half a clip on both sides.

    Where a motion is cut to itself, cells within `trivial` frames of going on are left out.
    InputError when no cell leaves as much.
    """
    half = clip_frames // 2
    near = trivial if a is b else -1
    point = cheapest(cost_matrix(a, b, weights), before=half, after=half, trivial=near)
    if point is None:
        raise InputError(
            f"cut: expected motions with {half} frames before it and after, found {len(a)} and "
            f"{len(b)} frames.\nTake longer motions or shorter clips."
        )
    return transition(a, b, point.i, point.j, method="cut")


def best_cuts(
    a: Motion, b: Motion, weight_sets: Sequence[str] = ("lee", "wang")
) -> Mapping[str, Transition]:
    """The best cut of six-second clips under each weight set."""
    return {weights: best_cut(a, b, weights) for weights in weight_sets}
