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

RUNS = 5
SAMPLES = 2000
DEMO_LEVELS = [0.001, 0.0015, 0.002, 0.0025, 0.003, 0.0035, 0.004, 0.0045, 0.005, 0.006, 0.007,
               0.008, 0.010]  # fmt: skip
DEMO_RIGHT = [45, 50, 44, 44, 52, 53, 62, 64, 76, 79, 88, 90, 90]


def rows() -> list[dict[str, Any]]:
    """Seconds of a fit with 2,000 bootstrap samples beside psignifit's without any, which it must
    beat by so many times, and of a report of 50 people."""
    thirteen = counts(DEMO_LEVELS, DEMO_RIGHT, [90] * 13)
    return [
        _times("fit, 13 levels, 2,000 bootstrap samples", 15.0, _fit(thirteen), _rival(thirteen)),
        _times("fit, 200 adaptive trials, 2,000 bootstrap samples", 50.0, *_adaptive()),
        _row("report, 50 people, 10,000 trials", 20.0, _report(), None),
    ]


def _row(name: str, target: float, value: float, rival: float | None) -> dict[str, Any]:
    return {
        "name": name,
        "value": value,
        "unit": "s",
        "rival": None if rival is None else "psignifit 4.3 (no bootstrap)",
        "rival_value": rival,
        "ratio": None if rival is None else rival / value,
        "target": target,
        "met": value <= target,
    }


def _times(name: str, target: float, value: float, rival: float | None) -> dict[str, Any]:
    """A row whose target is how many times faster than the rival it is."""
    row = _row(name, target, value, rival)
    return row | {"met": None if row["ratio"] is None else row["ratio"] >= target}


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


def _adaptive() -> tuple[float, float | None]:
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
    return _fit(data), _rival(data, runs=1)


def _report() -> float:
    rng = np.random.default_rng(2)
    sessions = {
        f"p{person:02d}": records.odd_pair_rows(rng, visits=24)[:200] for person in range(50)
    }
    with tempfile.TemporaryDirectory() as folder:
        protocol = records.odd_pair_protocol(analysis={"at": [0.70, 0.75], "bootstrap": SAMPLES})
        data = records.write_dataset(Path(folder), protocol, sessions)
        return seconds(lambda: write_report([data]), runs=3)
