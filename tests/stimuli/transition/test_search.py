"""The search in blocks finds what the whole matrices hold."""

import pytest

from stimuli.ties import ranks
from stimuli.transition.distance import cost_matrix
from stimuli.transition.points import local_minima
from stimuli.transition.search import blocks, search


@pytest.mark.parametrize("velocity_weight", [0.0, 1.0, 30.0])
def test_a_search_in_blocks_is_the_search_of_the_whole(bodies, velocity_weight):
    motions = [bodies.wandering(frames, seed) for seed, frames in enumerate((40, 61, 25))]
    every = sorted(
        (x, point.i, y, point.j, point.cost)
        for x, a in enumerate(motions)
        for y, b in enumerate(motions)
        for point in local_minima(
            cost_matrix(a, b, velocity_weight=velocity_weight), 3, 4, 5 if a is b else -1
        )
    )
    level = ranks([row[-1] for row in every])
    whole = [every[n] for n in sorted(range(len(every)), key=lambda n: (level[n], n))][:40]
    assert len({level[every.index(row)] for row in whole}) < 40, "a cell and its mirror image tie"
    told: list[int] = []
    found = search(
        motions, motions, count=40, velocity_weight=velocity_weight, before=3, after=4, trivial=5,
        block=17, progress=told.append,
    )  # fmt: skip
    assert [(f.from_motion, f.i, f.to_motion, f.j) for f in found] == [row[:4] for row in whole]
    assert all(abs(f.cost - row[-1]) < 1e-9 for f, row in zip(found, whole, strict=True))
    assert told[-1] == blocks(motions, motions, 17) == 64


def test_blocks_in_single_precision_find_the_same_points(bodies, monkeypatch):
    motions = [bodies.wandering(frames, seed) for seed, frames in enumerate((60, 45))]
    exact = search(motions, motions, count=20, block=33)
    monkeypatch.setattr("stimuli.transition.search.MANY", 0)
    fused = search(motions, motions, count=20, block=33)
    assert [(f.from_motion, f.i, f.to_motion, f.j) for f in fused] == [
        (f.from_motion, f.i, f.to_motion, f.j) for f in exact
    ]
    assert [f.cost for f in fused] == pytest.approx([f.cost for f in exact], abs=1e-5)


def test_a_motion_read_twice_meets_itself_too(bodies):
    once, again = bodies.wandering(60, 1), bodies.wandering(60, 1)
    assert search([once], [again], count=20) == search([once], [once], count=20)
