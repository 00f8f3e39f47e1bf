"""A cut whose discontinuity is spread on both sides (Arikan and Forsyth 2002, section 4.2.3).

`y(f)` is 0 a second before the cut, rises as a parabola to one half at it, falls there to minus one
half, and is 0 again a second after: added to the motion times the jump at the cut, it makes every
degree of freedom continuous. Rotations jump by rotation vectors.
"""

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.transition.align import aligned
from stimuli.transition.blend import spliced

SPREAD_OVER = 30  # frames on either side over which a jump is spread


def smoothing(before: int, after: int) -> tuple[Array, Array]:
    """y (before,) for the frames up to the cut, the last being the cut's own, and (after,) behind.

    Sides of different lengths share the jump so that its slope is one at the cut; equal ones halve
    it, as printed.
    """
    share = before / max(before + after, 1)
    rise = share * np.square(np.arange(1, before + 1) / max(before, 1))
    fall = -(1 - share) * np.square(1 - np.arange(1, after + 1) / max(after, 1))
    return rise, fall


def smoothed_cut(
    a: Motion, b: Motion, i: int, j: int, spread: int = SPREAD_OVER, keep: int = 0
) -> Motion:
    """A[..i], then B[j+1..], with B[j] where A[i] is and the jump between them spread.

    The first `keep` frames of A stay as they are. `b` is on the skeleton of `a`.
    """
    b = aligned(a, b, i, j)
    rise, fall = smoothing(max(min(spread, i + 1 - keep), 0), min(spread, len(b) - 1 - j))
    cut = spliced(a, b, i + 1, j + 1, a.rotations[:0], a.root[:0])
    jump = quat.log(quat.shorter(quat.multiply(quat.inverse(a.rotations[i]), b.rotations[j])))
    rows = slice(i + 1 - len(rise), i + 1 + len(fall))
    share = np.concatenate([rise, fall])
    rotations, root = cut.rotations, cut.root
    rotations[rows] = quat.multiply(rotations[rows], quat.exp(share[:, None, None] * jump))
    root[rows] += share[:, None] * (b.root[j] - a.root[i])
    return cut
