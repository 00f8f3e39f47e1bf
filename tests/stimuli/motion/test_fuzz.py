"""A fuzz run over the readers: damaged copies of real files are motions or refusals."""

import resource
from pathlib import Path

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion import load

FILES = ("messy/base.bvh", "messy/ok.amc", "messy/pos_all_joints_absolute.bvh",
         "messy/real_walk01_24fps.bvh", "accad_male1_bvh/Male1_C03_Run.bvh")  # fmt: skip
ROUNDS = 400
GLUE = [
    b"",
    b"\n",
    b" ",
    b"-",
    b"e9",
    b"nan",
    b"{",
    b"}",
    b"\x00",
    b"\xff",
    b"9" * 30,
    b"JOINT x\n{",
]


def damaged(data: bytes, rng: np.random.Generator) -> bytes:
    """Cut, swapped, repeated or overwritten in one to four places."""
    for _ in range(int(rng.integers(1, 5))):
        start = int(rng.integers(0, max(len(data), 1)))
        end = min(start + int(rng.integers(0, 40)), len(data))
        middle = GLUE[int(rng.integers(len(GLUE)))]
        if rng.integers(4) == 0:
            middle = data[start:end] * 3
        data = data[:start] + middle + data[end:]
    return data


@pytest.mark.slow
@pytest.mark.parametrize("name", FILES)
def test_damaged_files_never_hang_never_grow_never_give_nan(motions: Path, tmp_path, name):
    source = motions / name
    whole = source.read_bytes()
    for asf in source.parent.glob("ok.asf"):
        (tmp_path / asf.name).write_bytes(asf.read_bytes())
    rng = np.random.default_rng(1)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    path = tmp_path / source.name
    refusals: list[str] = []
    for _ in range(ROUNDS):
        path.write_bytes(damaged(whole, rng))
        try:
            motion = load(path).motion
        except InputError as error:
            refusals.append(str(error))
            continue
        assert np.all(np.isfinite(motion.rotations))
        assert np.all(np.isfinite(motion.root))
    assert 0 < len(refusals) < ROUNDS
    assert all(len(message.splitlines()) <= 2 for message in refusals)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000
