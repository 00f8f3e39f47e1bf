"""How many mutations a second the search tries where its loops are not compiled: run by `graphs`.

As a process of its own, since the compiler is off (NUMBA_DISABLE_JIT) from the start or not at all.
"""

import pickle
import sys
import time
from pathlib import Path

import numpy as np

from stimuli.graph.score_loop import MOST_NODES, Aim, Space, new_trace
from stimuli.graph.search_loop import climb

SECONDS, AT_ONCE = 4.0, 200


def main(given: Path) -> None:
    """Print mutations a second from an answer on, with endless patience."""
    space, aim, random, answer = pickle.loads(given.read_bytes())
    space = Space(*space)
    aim = Aim(*aim)._replace(effort=np.array([1, 1, 1 << 30, 0], np.int32))
    path = np.zeros(MOST_NODES, np.int32)
    path[: len(answer)] = answer
    traces = new_trace(aim), new_trace(aim)
    count, score, done, start = len(answer), np.inf, 0, time.process_time()
    with np.errstate(over="ignore"):  # random numbers wrap around
        while time.process_time() - start < SECONDS:
            count, score, tried, _ = climb(space, aim, random, path, count, score, AT_ONCE, *traces)
            done += tried
    print(done / (time.process_time() - start))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
