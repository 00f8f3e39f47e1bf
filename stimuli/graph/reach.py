"""How much of the floor, and of all headings, a graph's motions get to within some time.

Reitsma and Pollard (2004) ask of a motion graph that this be known. Random walks over the graph
begin at the origin, facing +Z; where each is after the time is where the body can be.
"""

import numpy as np

from stimuli.graph.score_loop import MOST_NODES, Space
from stimuli.motion.quaternions import Array

_CELL = 0.25  # metres of a side of a cell of the floor
SECTOR = 10.0  # degrees


def places_reached(space: Space, frames: int, walks: int, seed: int = 0) -> tuple[Array, Array]:
    """Place (N, 2) and heading (N,) after `frames` frames of random walks that last so long."""
    from stimuli.graph.walk_loop import random_walk

    random = np.random.SeedSequence([seed]).generate_state(1, np.uint64) | np.uint64(1)
    path = np.zeros(MOST_NODES, dtype=np.int32)
    place, yaw = [], []
    for _ in range(walks):
        count = random_walk(space, random, path, 0, 0, 0, frames, 1, False)
        end = end_of(space, path[:count], frames)
        if end is not None:
            place.append((end[0].imag, end[0].real))
            yaw.append(float(np.angle(end[1])))
    return np.array(place, dtype=float).reshape(-1, 2), np.array(yaw)


def end_of(space: Space, path: np.ndarray, frames: int) -> tuple[complex, complex] | None:
    """Where a walk from the origin is after `frames` frames, None where it is over before."""
    turn, shift, left = 1 + 0j, 0j, frames
    for n, node in enumerate(path):
        base, j = space.first[space.node_to[node]], space.node_j[node]
        onto = base + max(j, 0) if n else base + j + 1
        turn = turn * np.conj(space.turn[onto])
        shift = shift - turn * space.place[onto]
        stop = space.frames[space.node_to[node]] - 1
        if n + 1 < len(path):
            stop = space.node_i[path[n + 1]]
        last = base + min(stop, j + left)
        left -= stop - j
        shift, turn = shift + turn * space.place[last], turn * space.turn[last]
        if left <= 0:
            return complex(shift), complex(turn)
    return None


def shares(place: Array, yaw: Array) -> tuple[float, float]:
    """Square metres of floor reached, and the share of all headings."""
    cells = {(int(x), int(z)) for x, z in np.floor(place / _CELL)}
    sectors = set(np.floor(np.degrees(yaw) / SECTOR).astype(int) % int(360 / SECTOR))
    return len(cells) * _CELL**2, len(sectors) * SECTOR / 360
