"""A fuzz run over the readers: damaged copies of real files are motions or refusals."""

import re
import resource
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion import load_clip, write_walker
from stimuli.motion.formats.bvh_write import write_bvh
from stimuli.motion.formats.source import MOST_ROTATIONS
from tests.conftest import of_captured

ROOT = Path(__file__).resolve().parents[3]
FILES = ("messy/base.bvh", "messy/ok.amc", "messy/pos_all_joints_absolute.bvh",
         "messy/real_walk01_24fps.bvh", "accad_male1_bvh/Male1_C03_Run.bvh")  # fmt: skip
ROUNDS = 400
MOST_GROWTH = 200_000  # kilobytes on top of what is in use, for copies of files of a megabyte
MOST_MEMORY = 2_000_000  # kilobytes for a small file that makes as many rotations as are read
GLUE = [
    b"",
    b"\n",
    b" ",
    b"-",
    b".",
    b"E",
    b".-",
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


# what scales a motion: Frame Time, Frames, frame numbers of AMC, durations of DeepMimic
SCALES = re.compile(rb"(?<=Time:)\s*\S+|(?<=Frames:)\s*\S+|^\d+\r?$|(?<=\[)[0-9.]+", re.MULTILINE)
NUMBERS = [b"900", b"1", b"0.9", b"5e-4", b"1e-5", b"1e3", b"1e9", b"1e400", b"0", b"-1", b"nan",
           b"1_000", b"9" * 5000, b"0." + b"3" * 5000, "²".encode(), "١".encode(), b"true",
           b"[1]"]  # fmt: skip


def rescaled(data: bytes, rng: np.random.Generator) -> bytes:
    """Other rates, durations or numbers of frames, of two sizes, in one place or in many."""
    numbers = [NUMBERS[k] for k in rng.integers(len(NUMBERS), size=2)]
    share = rng.choice([1.0 / len(SCALES.findall(data)), 0.5, 1.0])

    def other(match: re.Match[bytes]) -> bytes:
        return numbers[int(rng.integers(2))] if rng.random() < share else match[0]

    return SCALES.sub(other, data)


def peak_afresh() -> int:
    """Kilobytes in use; where the system allows it, the peak that earlier tests left is forgotten.

    Elsewhere a growth shows only beyond what they took.
    """
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")
    return peak()


def peak() -> int:
    """Most kilobytes that this process has had since then."""
    status = Path("/proc/self/status")
    found = re.search(r"VmHWM:\s*(\d+)", status.read_text()) if status.exists() else None
    return int(found[1]) if found else resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def fuzz(whole: bytes, path: Path, damage: Callable, rounds: int) -> None:
    """Loads damaged copies: each is a motion or a refusal, and asks for no more than memory has."""
    rng = np.random.default_rng(1)
    before = peak_afresh()
    refusals: list[str] = []
    for _ in range(rounds):
        path.write_bytes(damage(whole, rng))
        try:
            motion = load_clip(path).motion
        except InputError as error:
            refusals.append(str(error))
            continue
        assert np.all(np.isfinite(motion.rotations))
        assert np.all(np.isfinite(motion.root))
    assert 0 < len(refusals) < rounds
    assert all(len(message.splitlines()) <= 2 for message in refusals)
    assert all(len(message) < 2_000 for message in refusals)
    assert peak() - before < MOST_GROWTH


@pytest.mark.slow
@pytest.mark.parametrize("damage", [damaged, rescaled])
@pytest.mark.parametrize("name", of_captured(FILES))
def test_damaged_files_never_hang_never_grow_never_give_nan(motions: Path, tmp_path, name, damage):
    source = motions / name
    for asf in source.parent.glob("ok.asf"):
        (tmp_path / asf.name).write_bytes(asf.read_bytes())
    fuzz(source.read_bytes(), tmp_path / source.name, damage, ROUNDS)


@pytest.mark.parametrize("damage", [damaged, rescaled])
def test_damaged_clips_of_deepmimic_neither(tmp_path, damage):
    path = write_walker(tmp_path)
    fuzz(path.read_bytes(), path, damage, 60)


def test_rates_and_counts_of_any_size_neither(bodies, tmp_path):
    path = tmp_path / "clip.bvh"
    write_bvh(bodies.wandering(20, 1), path)
    fuzz(path.read_bytes(), path, rescaled, 60)


READ_AND_TELL = """
import sys
from stimuli.motion import load_clip
from tests.stimuli.motion.test_fuzz import peak
print(load_clip(sys.argv[1], up="Z").motion.rotations.size // 4, peak())
"""


@pytest.mark.slow
def test_a_small_file_of_the_most_rotations_takes_bounded_memory(tmp_path):
    path, frames = tmp_path / "clip.bvh", MOST_ROTATIONS // 2_000 * 29 // 30 - 1
    joints = "".join(f"JOINT j{k}\n{{\nOFFSET 0 0 1\n}}\n" for k in range(1_999))
    path.write_text(
        f"HIERARCHY\nROOT r\n{{\nOFFSET 0 0 0\nCHANNELS 1 Zrotation\n{joints}}}\nMOTION\n"
        f"Frames: {frames}\nFrame Time: {1 / 29}\n" + "1\n" * frames
    )
    command = [sys.executable, "-c", READ_AND_TELL, str(path)]
    told = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout
    rotations, kilobytes = map(int, told.split())
    assert rotations > 0.99 * MOST_ROTATIONS
    assert kilobytes < MOST_MEMORY
