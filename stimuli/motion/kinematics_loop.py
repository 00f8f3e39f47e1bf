"""Forward kinematics as one compiled loop: a joint after the other, frame by frame."""

import numpy as np
import numpy.typing as npt

from stimuli.compiled import compiled, inlined
from stimuli.motion.quaternions import Array


@inlined
def _joined(p: Array, q: Array, product: Array) -> None:
    """The Hamilton product p q."""
    product[0] = p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3]
    product[1] = p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2]
    product[2] = p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1]
    product[3] = p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]


@inlined
def _reached(start: Array, q: Array, bone: Array, end: Array) -> None:
    """The end of a bone that is turned by q."""
    x = 2.0 * (q[2] * bone[2] - q[3] * bone[1])
    y = 2.0 * (q[3] * bone[0] - q[1] * bone[2])
    z = 2.0 * (q[1] * bone[1] - q[2] * bone[0])
    end[0] = start[0] + bone[0] + q[0] * x + q[2] * z - q[3] * y
    end[1] = start[1] + bone[1] + q[0] * y + q[3] * x - q[1] * z
    end[2] = start[2] + bone[2] + q[0] * z + q[1] * y - q[2] * x


@compiled(nogil=True)
def follow(
    rotations: Array,
    root: Array,
    offsets: Array,
    parents: npt.NDArray[np.int64],
    positions: Array,
    orientations: Array,
) -> None:
    """Fills positions (F, J, 3) and orientations (F, J, 4) of poses (F, J, 4) and (F, 3)."""
    for frame in range(len(rotations)):
        place, turn = positions[frame], orientations[frame]
        place[0] = root[frame]
        turn[0] = rotations[frame, 0]
        for joint in range(1, len(parents)):
            above = parents[joint]
            _joined(turn[above], rotations[frame, joint], turn[joint])
            _reached(place[above], turn[above], offsets[joint], place[joint])
