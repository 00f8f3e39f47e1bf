"""Data sets of generated records, shared by the tests of the analysis."""

from pathlib import Path

import numpy as np
import pytest

from tests.analysis import records


@pytest.fixture(scope="session")
def jnd(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Six people of jnd-center whose thresholds are −7 and +10."""
    rng = np.random.default_rng(3)
    sessions = {f"p{n:02d}": records.odd_pair_rows(rng) for n in range(6)}
    root = tmp_path_factory.mktemp("jnd")
    return records.write_dataset(root, records.odd_pair_protocol(), sessions)


@pytest.fixture(scope="session")
def study_one(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Study one of Wang V.2: 270 of 280 answers for the geodesic length."""
    root = tmp_path_factory.mktemp("one")
    sessions = records.counted_preferences(270, 35, 8)
    return records.write_dataset(root, records.preference_protocol(), sessions)
