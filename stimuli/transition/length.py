"""How long a blend should last: a fixed time, or by the geodesic distance (Wang 2005, V.1.1)."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stimuli.errors import InputError
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.ties import first_least
from stimuli.transition.distance import pose_distance
from stimuli.transition.weights import Weights
from stimuli.transition.window import LONGEST, Fits, Window, specified

FIXED = 10
LengthFunction = Callable[[Motion, Motion, int, int, str], "Length"]
GivenFunction = Callable[[Motion, Motion, int, int, str, int], "Length"]


@dataclass(frozen=True)
class Length:
    """A blend length in frames, and how the method came to it."""

    frames: int
    report: Mapping[str, Any] = field(default_factory=dict)


def length_none(a: Motion, b: Motion, i: int, j: int, specification: str) -> Length:
    """A cut lasts no time."""
    return Length(0)


def length_given(a: Motion, b: Motion, i: int, j: int, specification: str, frames: int) -> Length:
    """A length that somebody wants instead of the method's own."""
    return Length(frames, {"given": True})


def length_fixed(a: Motion, b: Motion, i: int, j: int, specification: str) -> Length:
    """Ten frames, a third of a second."""
    return Length(FIXED)


def geodesic_costs(
    a: Motion,
    b: Motion,
    i: int,
    j: int,
    specification: str,
    weights: str | Weights = "wang",
) -> Array:
    """The mean distance over the frames mixed for b = 1 … 60 (V.1, V.2); NaN where none fits."""
    reach = LONGEST
    from_a, from_b = max(i - reach, 0), max(j - reach, 0)
    distance = pose_distance(a[from_a : i + reach], b[from_b : j + reach], weights)
    costs = np.full(LONGEST, np.nan)
    make = specified(specification)
    for frames in range(1, LONGEST + 1):
        window = make(i, j, frames)
        if window.fits(a, b):
            rows = np.arange(window.first, window.last + 1)
            costs[frames - 1] = distance[rows - from_a, rows + window.lag - from_b].mean()
    return costs


def length_geodesic(
    a: Motion, b: Motion, i: int, j: int, specification: str, fits: Fits = Window.fits
) -> Length:
    """The length whose mixed frames differ least on average (V.1), the smaller one on a tie.

    Among those for which a way of joining finds its frames (`fits`).
    """
    costs = geodesic_costs(a, b, i, j, specification)
    make = specified(specification)
    room = [fits(make(i, j, frames), a, b) for frames in range(1, LONGEST + 1)]
    costs = np.where(room, costs, np.nan)
    if np.all(np.isnan(costs)):
        raise no_room(i, j)
    best = first_least(costs)
    return Length(best + 1, {"costs": costs, "cost": float(costs[best])})


def no_room(i: int, j: int) -> InputError:
    """The fault of a transition where even a blend of one frame leaves a motion."""
    return InputError(
        f"transition {i} → {j}: expected room for a blend, found none: "
        "even the shortest leaves a motion.\nChoose frames farther from the ends."
    )
