"""Where the curves of two clips come close in an embedding, beside what the cost says there."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from stimuli.manifold.embedding import Embedding
from stimuli.motion.quaternions import Array
from stimuli.transition.align import on_skeleton
from stimuli.transition.distance import cost_matrix
from stimuli.transition.points import local_minima

NAMED = 3  # meetings of a pair of clips


@dataclass(frozen=True)
class Meeting:
    """Frame i of one clip and j of another, near each other in the embedding.

    `apart` is how far (half-angle radians), `cost` the transition cost there (Wang IV.2), `cheaper`
    the share of all pairs of frames of the two clips that cost less. `best` is the cost's own
    cheapest pair (i, j), `nearer` the share of pairs that the embedding has nearer than that one.
    """

    from_clip: str
    i: int
    to_clip: str
    j: int
    apart: float
    cost: float
    cheaper: float
    best: tuple[int, int]
    nearer: float


def meetings(embedding: Embedding, dimensions: int, named: int = NAMED) -> list[Meeting]:
    """The nearest local minima of the distance between every two curves, nearest first."""
    found: list[Meeting] = []
    for a, b in combinations(range(len(embedding.motions)), 2):
        found += _of_pair(embedding, dimensions, a, b, named)
    return sorted(found, key=lambda m: (m.apart, m.from_clip, m.to_clip, m.i, m.j))


def _of_pair(embedding: Embedding, dimensions: int, a: int, b: int, named: int) -> list[Meeting]:
    first, other = embedding.motions[a], embedding.motions[b]
    apart = _apart(embedding, dimensions, a, b)
    cost = cost_matrix(first, on_skeleton(other, first.skeleton))
    i, j = (int(n) for n in np.unravel_index(int(np.argmin(cost)), cost.shape))
    nearer = float((apart < apart[i, j]).mean())
    return [
        Meeting(
            embedding.names[a], point.i, embedding.names[b], point.j, point.cost,
            float(cost[point.i, point.j]), float((cost < cost[point.i, point.j]).mean()),
            (i, j), nearer,
        )
        for point in local_minima(apart)[:named]
    ]  # fmt: skip


def _apart(embedding: Embedding, dimensions: int, a: int, b: int) -> Array:
    starts = embedding.starts
    one, two = (embedding.places[starts[n] : starts[n + 1], :dimensions] for n in (a, b))
    return np.asarray(np.linalg.norm(one[:, None] - two, axis=-1))
