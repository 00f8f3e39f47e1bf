"""Frames of one motion, or of several of one hierarchy together, in few dimensions (VII.2)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stimuli.errors import InputError
from stimuli.manifold.isomap import (
    MOST,
    knee_of,
    placed_by_landmarks,
    residual_variances,
    scaled,
    spread_landmarks,
    ways_in,
)
from stimuli.manifold.neighbours import (
    NEIGHBOURS,
    check_neighbours,
    check_whole,
    nearest_frames,
    neighbour_graph,
    pose_rotations,
)
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion

SCALED_WHOLE = 2000  # frames; more are placed by landmarks
LANDMARKS = 400


@dataclass(frozen=True, eq=False)
class Embedding:
    """Places (N, 10) of all frames, one clip after the other, half-angle radians.

    Their first d columns are the embedding in d dimensions, whose residual variance is
    `residual[d − 1]`. `starts` (C + 1,) is where each clip begins. `landmarks` counts the frames
    that the others were placed by, 0 where all were placed at once.
    """

    names: tuple[str, ...]
    motions: tuple[Motion, ...]
    places: Array
    residual: Array
    neighbours: int
    landmarks: int = 0

    @property
    def starts(self) -> np.ndarray:
        return starts_of(self.motions)

    @property
    def knee(self) -> int:
        """The dimensions at which the residual variance bends most."""
        return knee_of(self.residual)

    @property
    def clip_of(self) -> np.ndarray:
        """The clip (N,) of every frame."""
        return np.repeat(np.arange(len(self.motions)), [len(m) for m in self.motions])

    def frame_name(self, frame: int) -> str:
        """CLIP:FRAME of one of all frames."""
        clip = int(np.searchsorted(self.starts, frame, side="right")) - 1
        return f"{self.names[clip]}:{frame - int(self.starts[clip])}"

    def step(self, dimensions: int) -> float:
        """The motions' own speed: the median step from a frame to the next of its clip."""
        steps = np.linalg.norm(np.diff(self.places[:, :dimensions], axis=0), axis=1)
        return float(np.median(steps[np.diff(self.clip_of) == 0]))


def starts_of(motions: Sequence[Motion]) -> np.ndarray:
    """Where each of several motions begins (C + 1,), one put after the other."""
    return np.concatenate([[0], np.cumsum([len(m) for m in motions])])


def embed_motions(
    motions: Sequence[Motion],
    names: Sequence[str] | None = None,
    neighbours: int = NEIGHBOURS,
    seed: int = 0,
    whole: int = SCALED_WHOLE,
) -> Embedding:
    """Isomap of all frames on the geodesic pose distance of all joints but the root (VII.2).

    More than `whole` frames are placed by landmarks, which the seed draws. InputError for other
    hierarchies or rates, for too few frames, and for a neighbourhood graph in pieces, which are
    named and never joined.
    """
    names = tuple(names or (f"clip{n}" for n in range(len(motions))))
    poses = pose_rotations(motions)
    if len(poses) < MOST + 2:
        raise InputError(f"embedding: expected {MOST + 2} frames or more, found {len(poses)}.")
    check_neighbours(neighbours, len(poses))
    graph = neighbour_graph(*nearest_frames(poses, neighbours))
    labels = [f"{name}:{k}" for name, m in zip(names, motions, strict=True) for k in range(len(m))]
    check_whole(graph, poses, neighbours, labels)
    if len(poses) <= whole:
        ways = ways_in(graph)
        rows, places = np.arange(len(poses)), scaled(ways, MOST)
    else:
        rows = spread_landmarks(graph, min(LANDMARKS, len(poses)), np.random.default_rng(seed))
        ways = ways_in(graph, rows)
        places = placed_by_landmarks(ways, rows, MOST)
    residual = residual_variances(ways, rows, places)
    count = 0 if len(poses) <= whole else len(rows)
    return Embedding(names, tuple(motions), places, residual, neighbours, count)
