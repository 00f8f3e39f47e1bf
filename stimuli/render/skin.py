"""What is drawn of a body: a mesh in the reference pose and the bones that carry it."""

from dataclasses import dataclass, field
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray

# To the six faces and eight corners of a cube.
_DIRECTIONS = np.array(
    [way for way in product((-1, 0, 1), repeat=3) if np.abs(way).sum() in (1, 3)], dtype=float
)
BETWEEN = 0.02  # metres that a skin may reach beyond its outermost points, as it bends


@dataclass(frozen=True, eq=False)
class Skin:
    """Triangles in the reference pose, and which bones carry each of their points.

    Of discs, which always face the camera, `points` has the middle for each point of the rim, and
    `rims` the way from there, of length one; they are not lit.
    """

    points: NDArray[np.float32]  # (V, 3) metres
    normals: NDArray[np.float32]  # (V, 3)
    faces: NDArray[np.int32]  # (T, 3)
    weights: NDArray[np.float32]  # (V, B)
    openness: NDArray[np.float32]  # (V,) 1 in the open, towards 0 in folds
    sides: NDArray[np.float32]  # (V,) 1 on the left limbs, −1 on the right ones
    rims: NDArray[np.float32] = field(default_factory=lambda: np.zeros((0, 2), np.float32))

    @property
    def lit(self) -> bool:
        """Whether light falls on it; discs shine themselves."""
        return not len(self.rims)

    @cached_property
    def outermost(self) -> NDArray[np.intp]:
        """The points that tell how far it reaches: of each bone's, the farthest of 14 ways."""
        if not self.lit:
            return np.flatnonzero(~self.rims.any(axis=1))
        ways = _DIRECTIONS / np.linalg.norm(_DIRECTIONS, axis=1, keepdims=True)
        carrier = self.weights.argmax(axis=1)
        found = [
            own[(self.points[own] @ ways.T).argmax(axis=0)]
            for own in (np.flatnonzero(carrier == bone) for bone in np.unique(carrier))
        ]
        return np.unique(np.concatenate(found))
