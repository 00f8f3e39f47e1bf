"""Where the shared cases lie: beside the checkout; tests of them are skipped where they do not."""

from pathlib import Path

import pytest

from tests.conftest import NO_CASES

STAT = Path(__file__).resolve().parents[2].parent / "shared" / "cases" / "stat"


def stat_case(name: str) -> Path:
    """A file of the cases of statistics."""
    path = STAT / name
    if not path.exists():
        pytest.skip(NO_CASES)
    return path
