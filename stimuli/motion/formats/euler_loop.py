"""Rotations from the angles of a table, compiled: no array lies between the two."""

import math

import numpy as np
import numpy.typing as npt

from stimuli.compiled import compiled
from stimuli.motion.quaternions import Array

Whole = npt.NDArray[np.int64]


@compiled(nogil=True)
def turn(values: Array, joints: Whole, columns: Whole, axes: Whole, rotations: Array) -> None:
    """Fills `rotations` (F, J, 4) of some joints (N,) from degrees in `values` (F, C).

    `columns` (N, 3) are where the angles of a joint lie (−1 for none) and `axes` (N, 3) the three
    different axes, 1 to 3, about which they turn, each in the frame that those before it leave.
    """
    half = math.pi / 360.0
    for frame in range(len(values)):
        for place in range(len(joints)):
            first, second, third = columns[place, 0], columns[place, 1], columns[place, 2]
            a1 = values[frame, first] * half
            a2 = values[frame, second] * half if second >= 0 else 0.0
            a3 = values[frame, third] * half if third >= 0 else 0.0
            c1, c2, c3 = math.cos(a1), math.cos(a2), math.cos(a3)
            s1, s2, s3 = math.sin(a1), math.sin(a2), math.sin(a3)
            i, j, k = axes[place, 0], axes[place, 1], axes[place, 2]
            parity = 1.0 if (j - i) % 3 == 1 else -1.0
            q = rotations[frame, joints[place]]
            q[0] = c1 * c2 * c3 - parity * (s1 * s2 * s3)
            q[i] = s1 * c2 * c3 + parity * (c1 * s2 * s3)
            q[j] = c1 * s2 * c3 - parity * (s1 * c2 * s3)
            q[k] = c1 * c2 * s3 + parity * (s1 * s2 * c3)
