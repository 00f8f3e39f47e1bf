"""The loops of `edges`, compiled: which cells of a block are small, and costs of single pairs."""

import numpy as np
import numpy.typing as npt

from stimuli.compiled import compiled
from stimuli.graph.arrays import Rows
from stimuli.motion.quaternions import Array


@compiled(nogil=True)
def below(block: npt.NDArray[np.float32], limit: np.float32) -> tuple[Rows, Rows]:
    """Rows and columns, in order, of the cells of a block (R, N) that are below a limit."""
    counts = np.zeros(block.shape[0] + 1, dtype=np.int64)
    for row in range(block.shape[0]):
        count = 0
        for column in range(block.shape[1]):
            count += block[row, column] < limit
        counts[row + 1] = counts[row] + count
    rows, columns = np.empty(counts[-1], np.int64), np.empty(counts[-1], np.int64)
    for row in range(block.shape[0]):
        place = counts[row]
        if counts[row + 1] > place:
            for column in range(block.shape[1]):
                if block[row, column] < limit:
                    rows[place], columns[place] = row, column
                    place += 1
    return rows, columns


@compiled(nogil=True)
def costs_of(rows: Array, i: Rows, j: Rows) -> Array:
    """Squared distances (E,) of rows i and rows j."""
    costs = np.empty(len(i))
    for pair in range(len(i)):
        total = 0.0
        p, q = i[pair], j[pair]
        for column in range(rows.shape[1]):
            apart = rows[p, column] - rows[q, column]
            total += apart * apart
        costs[pair] = total
    return costs
