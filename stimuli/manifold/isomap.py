"""Isomap: points whose straight distances are the ways along a neighbourhood graph.

Tenenbaum, de Silva and Langford (2000), as Wang (2005, VII.2) has it: the graph of the nearest,
shortest ways in it, classical scaling of those. Many frames are placed by their ways to landmarks
(de Silva and Tenenbaum 2003), so that neither matrix is ever whole.
"""

from typing import Any

import numpy as np

from stimuli.motion.quaternions import Array

_FEW = 200  # frames; of more only the largest eigenvalues are looked for
MOST = 10  # dimensions whose residual variance is told (VII.2)


def ways_in(graph: Any, rows: np.ndarray | None = None) -> Array:
    """Lengths (N, N) of the shortest ways along a graph, or those (R, N) from some rows."""
    from scipy.sparse.csgraph import dijkstra

    return np.asarray(dijkstra(graph, directed=False, indices=rows))


def scaled(ways: Array, dimensions: int) -> Array:
    """Classical scaling of distances (N, N): places (N, d), the widest direction first.

    Each column is turned so that its largest coordinate is positive. Directions that no real
    distance is left for are zero.
    """
    values, vectors = _spectrum(_centred(np.square(ways)), dimensions)
    return _turned(vectors * np.sqrt(values))


def placed_by_landmarks(ways: Array, landmarks: np.ndarray, dimensions: int) -> Array:
    """Places (N, d) of all frames by the ways (M, N) from landmarks, which are scaled alone."""
    squares = np.square(ways[:, landmarks])
    values, vectors = _spectrum(_centred(squares), dimensions)
    held = values > 0
    pseudo = np.where(held, vectors / np.sqrt(np.where(held, values, 1.0)), 0.0)
    return _turned(-0.5 * (np.square(ways) - squares.mean(axis=1)[:, None]).T @ pseudo)


def spread_landmarks(graph: Any, count: int, generator: np.random.Generator) -> np.ndarray:
    """Frames (count,) far from one another along the graph: each the farthest from those before."""
    chosen = [int(generator.integers(graph.shape[0]))]
    near = ways_in(graph, np.array(chosen))[0]
    while len(chosen) < count:
        chosen.append(int(np.argmax(near)))
        near = np.minimum(near, ways_in(graph, np.array(chosen[-1:]))[0])
    return np.array(chosen)


def residual_variances(ways: Array, rows: np.ndarray, places: Array) -> Array:
    """1 − R² (d,) of ways (R, N) from `rows` and straight distances, in one to d dimensions."""
    ours = (np.arange(ways.shape[1])[None, :] != rows[:, None]).ravel()
    target = ways.ravel()[ours]
    target = target - target.mean()
    size = float(np.square(target).sum())
    square, left = np.zeros(ways.shape), []
    for column in places.T:
        square += np.square(column[rows][:, None] - column)
        straight = np.sqrt(square).ravel()[ours]
        straight -= straight.mean()
        shared = size * float(np.square(straight).sum())
        left.append(1 - float((target * straight).sum()) ** 2 / shared if shared > 0 else 1.0)
    return np.array(left)


def knee_of(residual: Array) -> int:
    """The dimensions at which a falling curve bends most: the farthest below its chord."""
    if len(residual) < 3:
        return int(np.argmin(residual)) + 1
    chord = np.linspace(residual[0], residual[-1], len(residual))
    return int(np.argmax(chord - residual)) + 1


def _centred(squares: Array) -> Array:
    """−½ J S J of squared distances, J the centring matrix."""
    mean = squares.mean(axis=0)
    centred = squares - mean
    centred -= mean[:, None]
    centred += mean.mean()
    centred *= -0.5
    return np.asarray(centred)


def _spectrum(product: Array, dimensions: int) -> tuple[Array, Array]:
    """The largest eigenvalues, none below zero, and their vectors (N, d)."""
    from scipy.linalg import eigh
    from scipy.sparse.linalg import eigsh

    last = len(product) - 1
    if last < _FEW:
        values, vectors = eigh(product, subset_by_index=[last - dimensions + 1, last])
    else:  # by Lanczos' method, from one and the same vector
        start = np.random.default_rng(0).normal(size=last + 1)
        values, vectors = eigsh(product, dimensions, which="LA", v0=start)
        order = np.argsort(values, kind="stable")
        values, vectors = values[order], vectors[:, order]
    return np.maximum(values[::-1], 0.0), vectors[:, ::-1]


def _turned(places: Array) -> Array:
    """Each column with its largest coordinate positive: eigenvectors have no sign of their own."""
    largest = np.argmax(np.abs(places), axis=0)
    return np.asarray(places * np.where(places[largest, np.arange(places.shape[1])] < 0, -1, 1))
