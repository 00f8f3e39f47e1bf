"""The transition methods: how long a blend lasts and how it joins two motions, in one table."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from stimuli.errors import InputError
from stimuli.motion.skeleton import Motion
from stimuli.transition.align import aligned, on_skeleton
from stimuli.transition.blend import blend_linear, spliced
from stimuli.transition.distance import check_pair
from stimuli.transition.length import (
    LENGTHS,
    Length,
    LengthFunction,
)
from stimuli.transition.window import check_frames, longest_fitting, specified


@dataclass(frozen=True, eq=False)
class Transition:
    """A joined motion: A from its frame 0, the blend, B to its end.

    Frame i of A is at index i of `motion` in both specifications (center-aligned: the instant).
    `frames` is the length b, 0 for a cut; `mixed` the first and last index of mixed frames.
    """

    motion: Motion
    method: str
    specification: str
    i: int
    j: int
    frames: int
    mixed: tuple[int, int]
    report: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Join:
    """What is to be joined: frame i of `a` with frame j of `b` (on the skeleton of `a`)."""

    a: Motion
    b: Motion
    i: int
    j: int
    specification: str
    length: Length
    smooth: bool


Joined = tuple[Motion, tuple[int, int]]


@dataclass(frozen=True)
class Method:
    """A rule for the length of a blend, and the way of blending."""

    length: LengthFunction
    blend: Callable[[Join], Joined]


def length_none(a: Motion, b: Motion, i: int, j: int, specification: str) -> Length:
    """A cut lasts no time."""
    return Length(0)


def join_cut(join: Join) -> Joined:
    """A[..i], then B[j+1..], with B[j] aligned to A[i]."""
    b = aligned(join.a, join.b, join.i, join.j)
    here = slice(join.i, join.i + 1)
    motion = spliced(join.a, b, join.i, join.j + 1, join.a.rotations[here], join.a.root[here])
    return motion, (join.i, join.i)


def join_linear(join: Join) -> Joined:
    """Slerp and linear interpolation over the window of the specification."""
    window = specified(join.specification)(join.i, join.j, join.length.frames)
    b = aligned(join.a, join.b, window.anchor, window.anchor + window.lag)
    return blend_linear(join.a, b, window, join.smooth), (window.first, window.last)


METHODS: Mapping[str, Method] = MappingProxyType(
    {
        "cut": Method(length_none, join_cut),
        **{name: Method(length, join_linear) for name, length in LENGTHS.items()},
    }
)


def transition(
    a: Motion,
    b: Motion,
    i: int,
    j: int,
    *,
    method: str = "geodesic",
    specification: str = "start-end",
    frames: int | None = None,
    smooth: bool = False,
    foot_lock: bool = False,
) -> Transition:
    """Join frame i of `a` with frame j of `b`, as a method and a specification have it.

    `frames` is a length to use instead of the method's own. `smooth` eases the weights by a
    smoothstep. InputError for different hierarchies, unknown names, frames that do not exist and
    windows that leave a motion.
    """
    check_pair(a, b)
    check_frames(a, b, i, j)
    window = specified(specification)
    if method not in METHODS:
        raise InputError(f"method: expected one of {', '.join(METHODS)}, found {method!r}.")
    if frames is None:
        length = METHODS[method].length(a, b, i, j, specification)
    elif method == "cut" and frames != 0:
        raise InputError(f"cut: expected no frames of blend, found {frames}.")
    else:
        length = Length(frames, {"given": True})
    if method != "cut" and (length.frames < 1 or not window(i, j, length.frames).fits(a, b)):
        raise InputError(
            f"{method} {specification} {i} → {j}: expected a length from 1 to "
            f"{longest_fitting(a, b, i, j, specification)} frames, found {length.frames}.\n"
            "Choose a shorter blend or frames farther from the ends."
        )
    join = Join(a, on_skeleton(b, a.skeleton), i, j, specification, length, smooth)
    motion, mixed = METHODS[method].blend(join)
    return Transition(
        motion,
        method,
        specification,
        i,
        j,
        length.frames,
        mixed,
        MappingProxyType(dict(length.report)),
    )
