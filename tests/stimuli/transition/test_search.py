"""The search in blocks finds what the whole matrices hold."""

from stimuli.transition.distance import cost_matrix
from stimuli.transition.points import local_minima
from stimuli.transition.search import blocks, search


def test_a_search_in_blocks_is_the_search_of_the_whole(bodies):
    motions = [bodies.wandering(frames, seed) for seed, frames in enumerate((40, 61, 25))]
    whole = sorted(
        (point.cost, x, point.i, y, point.j)
        for x, a in enumerate(motions)
        for y, b in enumerate(motions)
        for point in local_minima(cost_matrix(a, b), 3, 4, trivial=5 if a is b else -1)
    )[:40]
    told: list[int] = []
    found = search(
        motions, motions, count=40, before=3, after=4, trivial=5, block=17, progress=told.append
    )
    assert [(f.from_motion, f.i, f.to_motion, f.j) for f in found] == [row[1:] for row in whole]
    assert all(abs(f.cost - row[0]) < 1e-6 for f, row in zip(found, whole, strict=True))
    assert told[-1] == blocks(motions, motions, 17) == 64
