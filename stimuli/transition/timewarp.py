"""Blends of windows of two lengths, the shorter one stretched in time (Wang 2005, V.1.4).

The longer window is walked frame by frame, the shorter is stretched so that first meets first and
last meets last; fractional frames are slerped. Departures from the print, which `printed=True`
undoes: the endpoints meet, the mean replaces the sum (which always favours length 1), neither
window is more than twice the other.
"""

from dataclasses import dataclass

import numpy as np

from stimuli.errors import InputError
from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.motion.resample import sampled
from stimuli.motion.skeleton import Motion
from stimuli.ties import first_least
from stimuli.transition.align import aligned
from stimuli.transition.blend import blend_linear
from stimuli.transition.distance import joint_rotations
from stimuli.transition.join import Join, Joined
from stimuli.transition.length import Length, no_room
from stimuli.transition.weights import Weights, weighted_joints
from stimuli.transition.window import LONGEST, Window

MOST_STRETCH = 2


@dataclass(frozen=True, eq=False)
class _Pairs:
    """Window pairs (N,), the places that meet (N, M) relative to i and j, and how many meet."""

    frames_a: np.ndarray
    frames_b: np.ndarray
    places_a: Array
    places_b: Array
    meeting: np.ndarray


def length_timewarp(a: Motion, b: Motion, i: int, j: int, specification: str) -> Length:
    """The pair of windows that differ least on average; it lasts as long as the longer one."""
    return timewarped(a, b, i, j, specification)


def timewarped(
    a: Motion,
    b: Motion,
    i: int,
    j: int,
    specification: str,
    *,
    weights: str | Weights = "wang",
    printed: bool = False,
) -> Length:
    """The cheapest pair of window lengths, the shorter one on a tie; as printed if asked."""
    pairs, costs = timewarp_costs(a, b, i, j, specification, weights=weights, printed=printed)
    if np.all(np.isnan(costs)):
        raise no_room(i, j)
    return _cheapest(pairs, costs)


def given_timewarp(a: Motion, b: Motion, i: int, j: int, specification: str, frames: int) -> Length:
    """The cheapest pair of windows of which the longer lasts as long as is wanted."""
    pairs, costs = timewarp_costs(a, b, i, j, specification)
    lasting = pairs.max(axis=1)
    wanted = (lasting == frames) & ~np.isnan(costs)
    if not wanted.any():
        longest = lasting[~np.isnan(costs)].max(initial=0)
        raise InputError(
            f"{specification} timewarp {i} → {j}: expected a length from 1 to {longest} frames, "
            f"found {frames}.\nChoose a shorter blend or frames farther from the ends."
        )
    return _cheapest(pairs[wanted], costs[wanted])


def _cheapest(pairs: np.ndarray, costs: Array) -> Length:
    """The windows that differ least, the first of equals; the blend lasts as long as the longer."""
    best = first_least(costs)
    windows = (int(pairs[best, 0]), int(pairs[best, 1]))
    return Length(
        max(windows),
        {"from_frames": windows[0], "to_frames": windows[1], "cost": float(costs[best])},
    )


def timewarp_costs(
    a: Motion,
    b: Motion,
    i: int,
    j: int,
    specification: str,
    *,
    weights: str | Weights = "wang",
    printed: bool = False,
) -> tuple[np.ndarray, Array]:
    """Pairs (N, 2) of window lengths, shortest first, and their costs (N,); NaN where none fits.

    V.5 and V.6 to the letter when `printed`, which knows the start-end specification alone.
    """
    pairs = _as_printed() if printed else _PLACES[specification]()
    joints, scale = weighted_joints(a.skeleton, weights)
    near = LONGEST
    from_a, from_b = max(i - near, 0), max(j - near, 0)
    part_a, part_b = a[from_a : i + near + 1], b[from_b : j + near + 1]
    p = quat.continuous(joint_rotations(part_a, joints))
    q = quat.continuous(joint_rotations(part_b, joints))
    at_a, at_b = pairs.places_a + (i - from_a), pairs.places_b + (j - from_b)
    inside = (at_a >= 0) & (at_a <= len(p) - 1) & (at_b >= 0) & (at_b <= len(q) - 1)
    counted = np.arange(at_a.shape[1]) < pairs.meeting[:, None]
    fits = np.all(inside | ~counted, axis=1)
    squares = _squared_angles(p, q, at_a[fits], at_b[fits], scale)
    total = np.where(counted[fits], squares, 0.0).sum(axis=1)
    costs = np.full(len(pairs.meeting), np.nan)
    costs[fits] = total if printed else total / pairs.meeting[fits]
    return np.stack([pairs.frames_a, pairs.frames_b], axis=1), costs


def _squared_angles(p: Array, q: Array, at_p: Array, at_q: Array, weights: Array) -> Array:
    """Σ_k w_k θ² between p at places (N, M) and q at places (N, M); sequences (F, K, 4).

    One of the two places is whole. The inner product with a slerp is that combination of the
    inner products with its ends, so only those are needed.
    """
    dots = np.einsum("fkc,gkc->kfg", p, q)
    along_p, along_q = (quat.geodesic(x[1:], x[:-1]).T for x in (p, q))
    total = np.zeros(at_p.shape)
    (p0, p1, part_p), (q0, q1, part_q) = _between(at_p, len(p)), _between(at_q, len(q))
    for dot, step_p, step_q, weight in zip(dots, along_p, along_q, weights, strict=True):
        u0, u1 = _slerp_parts(step_p, p0, part_p)
        v0, v1 = _slerp_parts(step_q, q0, part_q)
        mixed = u0 * (v0 * dot[p0, q0] + v1 * dot[p0, q1])
        mixed += u1 * (v0 * dot[p1, q0] + v1 * dot[p1, q1])
        total += weight * np.square(np.arccos(np.minimum(np.abs(mixed), 1.0)))
    return total


def _between(places: Array, frames: int) -> tuple[np.ndarray, np.ndarray, Array]:
    """Frames before and after each place, and the part of the way."""
    inside = np.clip(places, 0, frames - 1)
    before = np.floor(inside + 1e-9).astype(int)
    return before, np.minimum(before + 1, frames - 1), np.maximum(inside - before, 0.0)


def _slerp_parts(steps: Array, before: np.ndarray, part: Array) -> tuple[Array, Array]:
    """Factors of the two frames around a place in their slerp."""
    angle = np.append(steps, 0.0)[before]
    near = angle < 1e-4
    sine = np.where(near, 1.0, np.sin(angle))
    first = np.where(near, 1.0 - part, np.sin((1.0 - part) * angle) / sine)
    second = np.where(near, part, np.sin(part * angle) / sine)
    return first, second


def _candidates() -> tuple[np.ndarray, np.ndarray]:
    """Pairs of window lengths, neither more than twice the other, shorter blends first."""
    a, b = (grid.ravel() for grid in np.mgrid[1 : LONGEST + 1, 1 : LONGEST + 1])
    order = np.lexsort((a + b, np.maximum(a, b)))
    a, b = a[order], b[order]
    bounded = np.maximum(a, b) <= MOST_STRETCH * np.minimum(a, b)
    return a[bounded], b[bounded]


def _start_end_places() -> _Pairs:
    a, b = _candidates()
    steps = np.arange(LONGEST)
    meeting = np.maximum(a, b)
    part = np.minimum(steps / np.maximum(meeting - 1, 1)[:, None], 1.0)
    places_a = part * (a - 1)[:, None]
    places_b = part * (b - 1)[:, None] - (b - 1)[:, None]
    return _Pairs(a, b, places_a, places_b, meeting)


def _center_places() -> _Pairs:
    a, b = _candidates()
    half_a, half_b = a // 2, b // 2
    half = np.maximum(half_a, half_b)
    steps = np.arange(2 * (LONGEST // 2) + 1) - half[:, None]
    part = np.minimum(steps / np.maximum(half, 1)[:, None], 1.0)
    return _Pairs(a, b, part * half_a[:, None], part * half_b[:, None], 2 * half + 1)


def _as_printed() -> _Pairs:
    """V.5 and V.6: at step t the *from* place is i + t·b_from/b_to − 1, or the *to* place so."""
    a, b = (grid.ravel() for grid in np.mgrid[1 : LONGEST + 1, 1 : LONGEST + 1])
    order = np.lexsort((a + b, np.maximum(a, b)))
    a, b = a[order], b[order]
    meeting = np.maximum(a, b)
    t = np.arange(1, LONGEST + 1)
    places_a = t * np.minimum(a / meeting, 1.0)[:, None] - 1
    places_b = t * np.minimum(b / meeting, 1.0)[:, None] - b[:, None]
    return _Pairs(a, b, places_a, places_b, meeting)


_PLACES = {"start-end": _start_end_places, "center-aligned": _center_places}


def join_timewarp(join: Join) -> Joined:
    """The windows stretched to one length and blended; in between A and B go at their own pace.

    The blend's middle lies later than frame i of A where A's window was stretched.
    """
    window = join.window
    count = window.last - window.first + 1
    frames_a, frames_b = (join.length.report[key] for key in ("from_frames", "to_frames"))
    if join.specification == "start-end":
        first_a, last_a = join.i, join.i + frames_a - 1
        first_b, last_b = join.j - frames_b + 1, join.j
        b = aligned(join.a, join.b, join.i, first_b)
    else:
        first_a, last_a = join.i - frames_a // 2, join.i + frames_a // 2
        first_b, last_b = join.j - frames_b // 2, join.j + frames_b // 2
        b = aligned(join.a, join.b, join.i, join.j)
    a = _stretched(join.a, first_a, last_a, count)
    b = _stretched(b, first_b, last_b, count)
    mixed = Window(
        first_a, first_a + count - 1, first_b - first_a, first_a, window.weights[0], window.frames
    )
    return Joined(blend_linear(a, b, mixed, join.smooth), (mixed.first, mixed.last), (a, b))


def _stretched(motion: Motion, first: int, last: int, count: int) -> Motion:
    """The motion with its frames `first` … `last` sampled as `count` frames."""
    rotations, root = sampled(motion.rotations, motion.root, np.linspace(first, last, count))
    return Motion(
        motion.skeleton,
        np.concatenate([motion.rotations[:first], rotations, motion.rotations[last + 1 :]]),
        np.concatenate([motion.root[:first], root, motion.root[last + 1 :]]),
        motion.fps,
    )
