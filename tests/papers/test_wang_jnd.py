"""Simulated studies of chapters V and VI: intervals hold the dissertation's thresholds.

Slow: forty studies of twelve people, sessions run by the session's own code.
"""

import numpy as np
import pytest

from analysis.certificate import Estimate, estimates
from analysis.preferences import contests
from analysis.thresholds import fit_plan_of
from study.cli.designs import SimulatedStudy, simulated_trials
from study.trials.reading import load_protocol

SEEDS = 40
HELD = 33


def studies(name: str, reference: int) -> list[list[Estimate]]:
    protocol = load_protocol(name)
    lengths = {pair.name: reference for pair in protocol.file.stimuli.motions}
    found = []
    for seed in range(SEEDS):
        trials, _, _ = simulated_trials(
            protocol,
            SimulatedStudy(dict(protocol.document), lengths, seed, protocol.file.participants),
        )
        found.append(estimates(trials, fit_plan_of(dict(protocol.document)), seed))
    return found


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "reference", "truth"),
    [
        ("jnd-center", 10, {"shorter": -7.0, "longer": 10.0}),
        ("jnd-start-end", 15, {"shorter": -3.0, "longer": 2.0}),
    ],
)
def test_intervals_hold_the_thresholds(name: str, reference: int, truth: dict[str, float]) -> None:
    found = studies(name, reference)
    for side, true in truth.items():
        own = [entry for study in found for entry in study if entry.side == side]
        held = sum(entry.low <= true <= entry.high and entry.ok for entry in own)
        mean = np.mean([entry.value for entry in own])
        print(f"\n{name}, {side}: {held} of {SEEDS} intervals hold {true:+g}; mean {mean:+.2f}")
        assert held >= HELD


@pytest.mark.slow
def test_chi_square_of_study_one() -> None:
    protocol = load_protocol("study-one")
    lengths: dict[str, int] = {}
    found = []
    for seed in range(SEEDS):
        study = SimulatedStudy(dict(protocol.document), lengths, seed, 35)
        trials, _, _ = simulated_trials(protocol, study)
        found.append(contests(trials, tuple(protocol.file.methods))[0].count.chi2)
    print(f"\nstudy one: χ² of {SEEDS} simulated studies, median {np.median(found):.1f}, "
          f"{min(found):.1f} to {max(found):.1f}")  # fmt: skip
    assert min(found) >= 210
    assert max(found) <= 270
