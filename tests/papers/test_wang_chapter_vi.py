"""Wang 2005, VI.3: people simulated at his thresholds give them back, seed after seed."""

import os
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pandas as pd
import pytest

from analysis.psychometric.bootstrap import people_counts
from analysis.psychometric.summary import summarise
from analysis.thresholds import plan_of
from study.protocol import load
from study.sets import references
from study.simulate import plan_of as session_plan
from study.simulate import rows

SEEDS = range(40)
ENOUGH = 33
PEOPLE = 12


def intervals(job: tuple[str, int]) -> dict[str, tuple[float, float, float]]:
    """The pooled threshold at .75 of each side of k, and its interval, from one simulated study."""
    name, seed = job
    protocol = load(name)
    lengths = references(protocol, None)
    table = pd.DataFrame(
        {"participant": person, **row}
        for person in range(PEOPLE)
        for row in rows(session_plan(protocol, lengths, seed, person))
        if row["phase"] == "main"
    )
    plan = plan_of(dict(protocol.document))
    found = {}
    for side, part in table.groupby("track"):
        data = people_counts(
            part["participant"].astype(str), part["difference"].abs(), part["correct"]
        )
        rng = np.random.default_rng(seed)
        fit = summarise(data, plan.what, (0.75,), interval="people", samples=1000, rng=rng)
        told = fit.as_dict()["threshold"]
        value, low, high = (
            np.nan if told[k] is None else told[k] for k in ("value", "low", "high")
        )
        found[str(side)] = (value, low, high)
    return found


@pytest.mark.slow
@pytest.mark.parametrize("name", ["jnd-center", "jnd-start-end"])
def test_pooled_intervals_hold_the_truth(name: str) -> None:
    with ProcessPoolExecutor(os.cpu_count(), mp_context=get_context("spawn")) as pool:
        studies = list(pool.map(intervals, [(name, seed) for seed in SEEDS]))
    observer = load(name).file.observer
    assert observer is not None
    for side in ("shorter", "longer"):
        truth = abs(getattr(observer, side))
        bounds = np.array([study[side] for study in studies])
        held = int(((bounds[:, 1] <= truth) & (truth <= bounds[:, 2])).sum())
        median = np.nanmedian(bounds[:, 0])
        print(f"{name} {side}: truth {truth}, median {median:.2f}, held in {held} of {len(SEEDS)}")
        assert held >= ENOUGH
