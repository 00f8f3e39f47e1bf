"""Embeddings: Isomap beside scikit-learn's own, and many frames in bounded memory."""

import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from stimuli.manifold.isomap import MOST, residual_variances, scaled, ways_in
from stimuli.manifold.neighbours import (
    NEIGHBOURS,
    nearest_of,
    neighbour_graph,
    pose_distances,
    pose_rotations,
)
from stimuli.motion import Motion, walker
from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from tests.benchmarks.rows import row

MANY = 5000
_EMBED = """
import resource, time
from stimuli.manifold import embed_motions
from tests.benchmarks.manifolds import moving
motion = moving({frames})
start = time.perf_counter()
embed_motions([motion])
print(time.perf_counter() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024**2)
"""


def rows() -> list[dict[str, Any]]:
    """Ratios to scikit-learn's Isomap and to the distances alone; seconds and memory of many."""
    poses = pose_rotations([moving(500)])
    distances = pose_distances(poses, poses)
    np.fill_diagonal(distances, 0.0)
    matrix = _seconds(lambda: pose_distances(poses, poses))
    ours, theirs = _seconds(lambda: _embedded(distances.copy())), _seconds(_their_own(distances))
    seconds, gigabytes = _many()
    return [
        row("embedding of 500 frames of a finished distance matrix, residual variances too", ours,
            "s", "scikit-learn's Isomap", theirs, faster=1 / 3),
        row("distance matrix of 500 frames", matrix, "s", "the embedding", ours),
        row(f"embedding of {MANY} frames by landmarks, all of it", seconds, "s", felt=30.0),
        row("the same, memory of the whole process", gigabytes, "GB", felt=2.0),
    ]  # fmt: skip


def moving(frames: int) -> Motion:
    """A smooth motion of every joint of a walker's body that repeats itself only nearly."""
    skeleton = walker().skeleton
    rng = np.random.default_rng(7)
    rate, phase = rng.uniform(0.9, 1.1, len(skeleton)), rng.uniform(0, 6, (len(skeleton), 3))
    angle = np.arange(frames)[:, None] * 2 * np.pi / 35 * rate
    slow = 1 + 0.3 * np.sin(np.arange(frames) / 150)[:, None, None]
    turns = 0.25 * slow * np.sin(angle[:, :, None] + phase)
    return Motion(skeleton, quat.exp(turns), np.zeros((frames, 3)))


def _seconds(work: Callable[[], object]) -> float:
    work()
    times = []
    for _ in range(5):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def _embedded(distances: Array) -> Array:
    ways = ways_in(neighbour_graph(*nearest_of(distances, NEIGHBOURS)))
    places = scaled(ways, MOST)
    return residual_variances(ways, np.arange(len(ways)), places)


def _their_own(distances: Array) -> Callable[[], object]:
    from sklearn.manifold import Isomap

    return lambda: Isomap(
        n_neighbors=NEIGHBOURS, n_components=MOST, metric="precomputed"
    ).fit_transform(distances)


def _many() -> tuple[float, float]:
    """Seconds, and the largest memory of a process that does nothing else, in gigabytes."""
    told = subprocess.run(
        [sys.executable, "-c", _EMBED.format(frames=MANY)], check=True, text=True,
        stdout=subprocess.PIPE,
    )  # fmt: skip
    seconds, gigabytes = told.stdout.split()
    return float(seconds), float(gigabytes)
