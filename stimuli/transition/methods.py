"""The transition methods: how long a blend lasts and how it joins two motions, in one table."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from types import MappingProxyType
from typing import Any

from stimuli.errors import InputError
from stimuli.motion.skeleton import Motion
from stimuli.transition.align import on_skeleton
from stimuli.transition.decay import decay_quintic, decay_spring
from stimuli.transition.distance import check_pair
from stimuli.transition.footlock import lock_feet
from stimuli.transition.join import Join, Joined, join_cut, join_linear, join_route
from stimuli.transition.length import (
    GivenFunction,
    Length,
    LengthFunction,
    length_fixed,
    length_geodesic,
    length_given,
    length_none,
)
from stimuli.transition.route import Route
from stimuli.transition.schedule import given_per_joint, join_per_joint, length_per_joint
from stimuli.transition.switch import (
    join_dead,
    join_inertialized,
    room_to_decay,
    room_to_extrapolate,
)
from stimuli.transition.timewarp import given_timewarp, join_timewarp, length_timewarp
from stimuli.transition.velocity import length_velocity, length_velocity_speed
from stimuli.transition.window import Window, check_frames, specified


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
    sources: tuple[Motion, Motion] | None = None  # A and B as captured
    played: tuple[Motion, Motion] | None = None  # the same at the pace at which they were joined


@dataclass(frozen=True)
class Method:
    """A rule for the length of a blend, the way of blending, and what a given length means.

    What a method goes `through` is a "collection" of other motions or an "embedding" of the two, in
    which its caller has found a route: its length and how it is reached.
    """

    length: LengthFunction
    blend: Callable[[Join], Joined]
    given: GivenFunction = length_given
    through: str = ""


def _routes(name: str, through: str, lacking: str) -> Method:
    """A method whose way is found before: two motions alone do not say how long it is."""

    def length(a: Motion, b: Motion, i: int, j: int, specification: str) -> Length:
        raise InputError(f"{name}: {lacking}")

    def given(a: Motion, b: Motion, i: int, j: int, specification: str, frames: int) -> Length:
        raise InputError(
            f"{name}: expected no length, which its way has itself, found {frames}.\nLeave it out."
        )

    return Method(length, join_route, given, through)


_geodesic_to_decay = partial(length_geodesic, fits=room_to_decay)


_NO_COLLECTION = (
    "expected a collection of clips through which a way leads, found none.\n"
    "In a protocol give each set a table [sets.NAME.collection]; elsewhere name a directory with "
    "--motions."
)
_NO_EMBEDDING = (
    "expected a way through the embedding of both motions, found none.\n"
    "In a protocol and in `segue blend` it is found; elsewhere call stimuli.manifold.passing."
)
METHODS: Mapping[str, Method] = MappingProxyType(
    {
        "cut": Method(length_none, join_cut),
        "fixed": Method(length_fixed, join_linear),
        "geodesic": Method(length_geodesic, join_linear),
        "velocity": Method(length_velocity, join_linear),
        "velocity-speed": Method(length_velocity_speed, join_linear),
        "timewarp": Method(length_timewarp, join_timewarp, given_timewarp),
        "per-joint": Method(length_per_joint, join_per_joint, given_per_joint),
        "inertialization": Method(_geodesic_to_decay, join_inertialized(decay_quintic)),
        "inertialization-spring": Method(_geodesic_to_decay, join_inertialized(decay_spring)),
        "dead-blending": Method(partial(length_geodesic, fits=room_to_extrapolate), join_dead),
        "motion-graph": _routes("motion-graph", "collection", _NO_COLLECTION),
        "manifold": _routes("manifold", "embedding", _NO_EMBEDDING),
    }
)
PAIRWISE = tuple(name for name, method in METHODS.items() if not method.through)


def blend_length(
    a: Motion, b: Motion, i: int, j: int, method: str, specification: str = "start-end",
    route: Route | None = None,
) -> Length:  # fmt: skip
    """How long a blend from frame i of `a` to frame j of `b` should last, by a method's own rule.

    `route` is the way of methods that go through other motions.
    InputError for motions of different hierarchies, frames that do not exist, unknown names.
    """
    check_pair(a, b)
    check_frames(a, b, i, j)
    specified(specification)
    way = _method(method)
    if way.through and route is not None:
        return _routed(method, route, specification)
    return way.length(a, b, i, j, specification)


def _routed(method: str, route: Route, specification: str) -> Length:
    """The frames that a route takes, after which frame j of B is reached."""
    if specification != "start-end":
        raise InputError(
            f"{method}: expected the specification start-end, which leaves A at frame i and "
            f"reaches frame j of B, found {specification}.\nBoth at one instant leave no way."
        )
    return Length(route.frames, {"cuts": route.cuts, "cuts_cost": round(route.cost, 6)})


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
    route: Route | None = None,
) -> Transition:
    """Join frame i of `a` with frame j of `b`, as a method and a specification have it.

    `frames` is a length to use instead of the method's own. `smooth` eases the weights of the
    methods that have weights by a smoothstep. `foot_lock` holds feet that stand. `route` is the way
    from i to j of methods that go through other motions (`METHODS[method].through`). InputError for
    different hierarchies, unknown names, frames that do not exist and windows that leave a motion.
    """
    check_pair(a, b)
    check_frames(a, b, i, j)
    specified(specification)
    way = _method(method)
    if frames is None and way.through and route is not None:
        length = _routed(method, route, specification)
    elif frames is None:
        length = way.length(a, b, i, j, specification)
    else:
        length = way.given(a, b, i, j, specification, frames)
    join = Join(
        a, on_skeleton(b, a.skeleton), i, j, specification, length, smooth, route, foot_lock
    )
    motion, mixed, warped, settled = way.blend(join)
    played = warped or (a, b)
    if foot_lock and length.frames and not way.through:
        motion = lock_feet(motion, *played, _mixing(join, motion, mixed, len(played[1])))
    return Transition(
        motion,
        method,
        specification,
        i,
        j,
        length.frames,
        mixed,
        MappingProxyType(dict(length.report) | dict(settled)),
        (a, b),
        played,
    )


def _mixing(join: Join, motion: Motion, mixed: tuple[int, int], frames_of_b: int) -> Window:
    """The window of the frames mixed, whose lag is told by where B's frames end up."""
    lag = frames_of_b - len(motion)
    first, last = mixed
    plain = join.window
    if (first, lag) == (plain.first, plain.lag):
        return plain
    return Window(first, last, lag, first, 1 / (join.length.frames + 1), join.length.frames)


def _method(name: str) -> Method:
    if name not in METHODS:
        raise InputError(f"method: expected one of {', '.join(METHODS)}, found {name!r}.")
    return METHODS[name]
