"""Fits beside psignifit, and a whole report."""

import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from analysis.psychometric import Counts, counts, proportion, setting, summarise
from analysis.report import write_report
from tests.analysis import records
from tests.benchmarks.rows import row

RUNS = 5
SAMPLES = 2000
RIVAL = "psignifit 4.3 (no bootstrap)"
DEMO_LEVELS = [0.001, 0.0015, 0.002, 0.0025, 0.003, 0.0035, 0.004, 0.0045, 0.005, 0.006, 0.007,
               0.008, 0.010]  # fmt: skip
DEMO_RIGHT = [45, 50, 44, 44, 52, 53, 62, 64, 76, 79, 88, 90, 90]


def rows() -> list[dict[str, Any]]:
    """Seconds of a fit with 2,000 bootstrap samples beside psignifit's without any, which it must
    beat by so many times, and of a report of 50 people."""
    thirteen = counts(DEMO_LEVELS, DEMO_RIGHT, [90] * 13)
    name = "fit, {}, 2,000 bootstrap samples"
    return [
        row(name.format("13 levels"), _fit(thirteen), "s", RIVAL, _rival(thirteen), faster=15.0),
        row(name.format("200 adaptive trials"), *_adaptive(), faster=50.0),
        row("report, 50 people, 10,000 trials", _report(), "s", felt=20.0),
    ]


def seconds(work: Callable[[], object], runs: int = RUNS) -> float:
    """Median of several runs, after one that warms up."""
    work()
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return median(times)


def _fit(data: Counts) -> float:
    what = setting("cumulative-normal")
    return seconds(lambda: summarise(data, what, interval="parametric", samples=SAMPLES))


def _rival(data: Counts, runs: int = 3) -> float | None:
    try:
        import psignifit
    except ImportError:
        return None
    table = np.stack([data.levels, data.correct, data.total], 1)

    def work() -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            psignifit.psignifit(table, experiment_type="2AFC", sigmoid="norm")

    if runs > 1:
        return seconds(work, runs)
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def _adaptive() -> tuple[float, str, str, float | None]:
    """Two hundred trials at levels that follow the answers and are hardly ever the same twice."""
    rng = np.random.default_rng(1)
    level, levels, correct = 8.0, [], []
    for _ in range(200):
        right = rng.random() < float(proportion("cumulative-normal", level, 5.0, 0.6, 0.5, 0.02))
        levels.append(level)
        correct.append(int(right))
        step = rng.uniform(0.1, 0.5)
        level = float(np.clip(level + (-step if right else 3 * step), 0.1, 12))
    data = counts(levels, correct)
    # psignifit takes half a minute here: once is enough to tell.
    return _fit(data), "s", RIVAL, _rival(data, runs=1)


def _report() -> float:
    rng = np.random.default_rng(2)
    sessions = {
        f"p{person:02d}": records.odd_pair_rows(rng, visits=24)[:200] for person in range(50)
    }
    with tempfile.TemporaryDirectory() as folder:
        protocol = records.odd_pair_protocol(analysis={"at": [0.70, 0.75], "bootstrap": SAMPLES})
        data = records.write_dataset(Path(folder), protocol, sessions)
        return seconds(lambda: write_report([data]), runs=3)
