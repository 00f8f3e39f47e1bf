"""A session killed at every step and at random times loses no answer and goes on the same."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork a session")
def test_whenever_a_session_is_killed_it_goes_on_bit_for_bit() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "tests.study.session.drill", "200"],
        cwd=ROOT, capture_output=True, text=True, timeout=500, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["faults"] == []
    assert found["rows"] == 4
    assert found["steps"] > 100  # every call that writes, from the first folder to the last sidecar
    assert found["times"] == 200
