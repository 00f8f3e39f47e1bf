"""How far a standing foot is to be moved in every frame so that it does not slide.

Steps are held as far as a blend has put them there: what a foot does by itself is left as it is.
The correction x minimises what is left of the slide while the foot stands, the acceleration that it
adds, and its size: a smoothing spline through the swings, stiff where the foot is planted. Where a
swing is too short to bring the foot from one place to the next, a little slide is left instead of a
jerk. It begins in the swing before the blend, or with the blend where the foot stands then, and is
gone soon after the last plant that the blend touches, however long that stands.
"""

import numpy as np
from scipy.linalg.lapack import dpbsv

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array

EASE = 10  # frames at the most over which a correction comes, before a blend
SETTLE = 16  # frames at the most over which it goes, after a plant
HELD = 300.0  # frames²: what a metre a frame of slide counts beside a metre a frame² added
SMALL = 1e-4  # the same for a metre of correction in a swing, a frame⁴
CREEP = 0.01  # and where the foot stands: who stands on creeps back within seconds
TOWARD = 0.3  # the same for a metre from as far as the leg reaches, where that is not far enough
UNCHANGED = (
    1e-6  # metres a frame that a step may differ from the captured one, and is left as it is
)
FAINT = 4e-4  # metres a frame by which steps differ without anybody seeing it
APART = 1e-3  # metres by which two places of a foot differ without anybody seeing it

Plant = tuple[int, int]  # first and last frame


def touching(plants: list[Plant], start: int, end: int) -> list[Plant]:
    """Those that meet a blend from `start` to `end`, or a frame beside it."""
    return [(p, q) for p, q in plants if q >= start - 1 and p <= end + 1]


def slid(steps: Array, captured: Array) -> Array:
    """Steps over the floor (..., 3) that are to be held, beside those `captured` (..., 3).

    None where the foot does as it was captured, which no blend has put there; all of them where a
    blend has changed them visibly.
    """
    return steps * visible(quat.norm(steps - captured), FAINT)[..., None]


def visible(sizes: Array, faint: float) -> Array:
    """0 for sizes that are nothing but rounding, one half for `faint` ones, to 1."""
    changed = np.maximum(sizes - UNCHANGED, 0.0) ** 4
    return np.asarray(changed / (changed + faint**4))


def corrections(
    steps: Array,
    plants: list[Plant],
    start: int,
    end: int,
    ends: bool,
    reached: Array,
    short: Array,
) -> Array:
    """How far (N, 3) a foot is to be moved, from the `steps` to be held (N, 3) and its plants.

    `plants` are all of the foot's, in order, `start` and `end` the first and last frame of the
    blend: outside, the sources move as captured, which is left as it is. Where the motion `ends`
    with these frames, a correction need not have gone by then. `reached` (N, 3) is what the leg
    reaches of a correction, which counts as far as that is `short` (N,) of it, 0 to 1.
    """
    shift = np.zeros_like(steps)
    touched = touching(plants, start, end)
    if not touched:
        return shift
    first, stop = _moved_from_to(plants, touched, start, len(steps))
    weight, wanted = np.zeros(len(steps) + 1), np.zeros((len(steps) + 1, 3))
    close = np.full(len(steps), SMALL)
    for p, q in touched:
        close[p : q + 1] = CREEP
        weight[p + 1 : q + 1] = HELD
        of_blend = slice(max(p + 1, start), min(q, end + 1) + 1)
        wanted[of_blend] = -steps[of_blend]
    weight[:-1] *= 1 - short
    weight[1:] *= 1 - short
    pull = TOWARD * short
    part, rows = slice(first, stop + 1), slice(first, stop)
    shift[rows] = _smoothest(
        weight[part],
        wanted[part],
        (close * (1 - short) + pull)[rows],
        (pull[:, None] * reached)[rows],
        (start == 0, ends and stop == len(steps)),
    )
    return shift


def _moved_from_to(
    plants: list[Plant], touched: list[Plant], start: int, frames: int
) -> tuple[int, int]:
    """The first frame that may be moved, and the one after the last."""
    before = [q for p, q in plants if q < touched[0][0]]
    after = [p for p, q in plants if p > touched[-1][1]]
    first = max([start - EASE, 0, *(q + 1 for q in before)])
    if touched[0][0] < start:
        first = start
    return first, min([touched[-1][1] + 1 + SETTLE, frames, *after])


def _smoothest(
    weight: Array, wanted: Array, close: Array, toward: Array, free: tuple[bool, bool]
) -> Array:
    """x (N, 3) of the least Σ weight |x_t − x_{t−1} − wanted_t|² + |x″|² + close |x|² − 2 toward x.

    `weight` (N + 1,) and `wanted` (N + 1, 3) are of the steps into every frame and out of the last,
    `close` (N,) and `toward` (N, 3) of the frames. x is 0 before and after, unless it is `free`
    where the motion starts or ends.
    """
    size = len(weight) - 1
    bends = np.ones(size + 2)  # of x″ at every frame and at the one before and after
    bends[: 2 * free[0]] = 0.0
    bends[size + 2 - 2 * free[1] :] = 0.0
    bands = np.zeros((3, size))
    bands[2] = close + weight[:-1] + weight[1:] + bends[:-2] + 4 * bends[1:-1] + bends[2:]
    bands[1, 1:] = -weight[1:-1] - 2 * bends[1:-2] - 2 * bends[2:-1]
    bands[0, 2:] = bends[2:-2]
    pull = weight[:, None] * wanted
    return np.asarray(dpbsv(bands, pull[:-1] - pull[1:] + toward)[1])
