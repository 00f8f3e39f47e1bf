"""Motion and transitions: reading, kinematics, the pose distance, lengths, a whole transition.

Everything is measured on generated data of the sizes that the figures are stated for, so that the
numbers are the same kind everywhere; rivals get the same data in the same run.
"""

import importlib
import itertools
import json
import statistics
import subprocess
import sys
import tempfile
import time
import tracemalloc
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from stimuli.motion import Motion, Skeleton, forward, load_clip, unroll, walker
from stimuli.motion import quaternions as quat
from stimuli.motion.formats.bvh import read_bvh
from stimuli.motion.formats.bvh_write import write_bvh
from stimuli.motion.quaternions import Array
from stimuli.transition import transition
from stimuli.transition.distance import exact_angles
from stimuli.transition.kernel import fused_angles
from stimuli.transition.lengthmap import lengths_of
from stimuli.transition.search import BLOCK, search
from stimuli.transition.weights import MAJOR, WEIGHTS, weighted_joints
from tests.benchmarks.rows import row

RUNS = 15
FRAMES, JOINTS = 524, 31
DIGITS = {"one digit": ".1f", "few digits": ".4f", "many digits": ".17g"}
A_ROTATION = 32  # bytes in memory, for each three numbers of a file
ALL_PAIRS = 2000
LIBRARY = 20_000


def rows() -> list[dict[str, Any]]:
    """Milliseconds, medians of several runs, in a process that has loaded its loops.

    Loading them takes half a second, once; a process that reads a handful of clips goes without.
    """
    importlib.import_module("numba")
    return [
        *_reading(), *_kinematics(), *_distance(), *_search(), *_lengths(), *_transition()
    ]  # fmt: skip


def _median(work: Callable[[], object], runs: int = RUNS) -> float:
    """Milliseconds of a call, after one that is not counted."""
    work()
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return 1000 * statistics.median(times)


def _row(
    name: str,
    value: float,
    rival: str | None = None,
    rival_value: float | None = None,
    *,
    target: float | None = None,
    faster: float | None = None,
    unit: str = "ms",
) -> dict[str, Any]:
    """A row; met when the rival takes `faster` times as long, or where `target` is felt."""
    return row(name, value, unit, rival, rival_value, faster=faster, felt=target)


def _body(frames: int, joints: int = JOINTS) -> Motion:
    """A motion of a body of chains like a captured one: six limbs below a root."""
    parents = [-1] + [0 if joint % 5 == 1 else joint - 1 for joint in range(1, joints)]
    rng = np.random.default_rng(0)
    skeleton = Skeleton(
        tuple(f"joint{n}" for n in range(joints)),
        np.array(parents),
        np.vstack([np.zeros(3), rng.normal(0, 0.2, (joints - 1, 3))]),
        np.array([joint for joint in range(joints) if joint not in parents]),
        rng.normal(0, 0.1, (sum(joint not in parents for joint in range(joints)), 3)),
    )
    steps = np.cumsum(rng.normal(0, 0.02, (frames, joints, 3)), axis=0)
    root = np.cumsum(rng.normal(0, 0.01, (frames, 3)), axis=0) + np.array([0.0, 0.9, 0.0])
    return Motion(skeleton, quat.exp(steps), root)


def _reading() -> list[dict[str, Any]]:
    """Files of short clips and of long ones, with few digits and with all that a double has."""
    import bvhio

    rows = []
    with tempfile.TemporaryDirectory() as directory:
        for frames in (FRAMES, LIBRARY):
            for digits, form in DIGITS.items():
                path = _written(Path(directory), frames, form)
                rows += _read(
                    path, f"read BVH, {frames} frames × {JOINTS} joints, {digits}", frames
                )
        path = _written(Path(directory), FRAMES, DIGITS["few digits"])
        ours = _median(lambda: read_bvh(path, path.read_bytes()))
        whole = _median(lambda: load_clip(path, up="Y", scale=1.0))
        slower = _median(lambda: bvhio.readAsBvh(str(path)), 5)
        theirs = _by_pybvh(path, RUNS)
        name = f"read BVH, {FRAMES} frames × {JOINTS} joints, few digits"
        rows += [
            _row(name, ours, "bvhio", slower),
            _row(f"{name}, to a clip", whole, "pybvh (reads only)", theirs),
        ]
    return rows


def _written(directory: Path, frames: int, form: str) -> Path:
    """A file whose numbers are written in a form."""
    path = directory / "long.bvh"
    write_bvh(_body(frames), path)
    head, _, numbers = path.read_text().partition("Frame Time")
    first, *table = numbers.splitlines()
    rows = [" ".join(format(float(word) / 3, form) for word in line.split()) for line in table]
    path.write_text("\n".join([head + "Frame Time" + first, *rows]) + "\n")
    return path


def _read(path: Path, name: str, frames: int) -> list[dict[str, Any]]:
    """Milliseconds and the peak of memory beside pybvh and three times the file.

    Where numbers have so few digits that their rotations alone are twice the file, or nearly, the
    file, a twentieth more than these and 50 kB are what a reader can hold to.
    """
    runs = RUNS if frames < LIBRARY else 5
    ours = _median(lambda: read_bvh(path, path.read_bytes()), runs)
    tracemalloc.start()
    read_bvh(path, path.read_bytes())
    peak = tracemalloc.get_traced_memory()[1] / 1e6
    tracemalloc.stop()
    size = path.stat().st_size / 1e6
    least = size + 1.05 * frames * JOINTS * A_ROTATION / 1e6 + 0.05
    most = max(3 * size, least)
    return [
        _row(name, ours, "pybvh", _by_pybvh(path, runs), faster=1.0),
        _row(f"{name}: memory", peak, "the file", size, target=most, unit="MB"),
    ]


def _by_pybvh(path: Path, runs: int) -> float:
    import pybvh

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return _median(lambda: pybvh.read_bvh_file(str(path)), runs)


def _kinematics() -> list[dict[str, Any]]:
    from pymotion.ops import skeleton as rival

    motion = _body(2000)
    skeleton = motion.skeleton
    ours = _median(lambda: forward(skeleton, motion.rotations, motion.root))
    parents = np.maximum(skeleton.parents, 0)
    theirs = _median(lambda: rival.fk(motion.rotations, motion.root, skeleton.offsets, parents))
    name = "forward kinematics, 2000 frames × 31 joints"
    return [_row(name, ours, "upc-pymotion", theirs, faster=4.0)]


def _rotations() -> tuple[Array, Array, Array]:
    rng = np.random.default_rng(1)
    rest = rng.normal(size=(1, len(MAJOR), 4))
    p, q = (
        quat.normalise(rest + 0.3 * rng.normal(size=(ALL_PAIRS, len(MAJOR), 4))) for _ in range(2)
    )
    return p, q, np.array([WEIGHTS["wang"][role] for role in MAJOR])


def _distance() -> list[dict[str, Any]]:
    """All pairs of 2,000 × 2,000 frames with eight weighted joints."""
    p, q, weights = _rotations()
    ours = _median(lambda: fused_angles(p, q, weights), 60)
    exact = _median(lambda: exact_angles(p, q, weights), 3)
    single = _median(lambda: _numpy_single(p, q, weights), 3)
    error = float(np.abs(fused_angles(p, q, weights) - exact_angles(p, q, weights)).max())
    name = "pose distance, 2000 × 2000 frames × 8 joints"
    return [
        _row(f"{name} (largest error {error:.1g})", ours, "NumPy arccos, float64", exact,
             faster=20.0),
        _row(name, ours, "NumPy arccos, float32", single),
    ]  # fmt: skip


def _numpy_single(p: Array, q: Array, weights: Array) -> Any:
    """The vectorised arccos version in single precision."""
    first, second = p.astype(np.float32), q.astype(np.float32)
    total = np.zeros((len(p), len(q)), dtype=np.float32)
    for joint, weight in enumerate(weights.astype(np.float32)):
        dots = np.abs(first[:, joint] @ second[:, joint].T)
        total += weight * np.square(np.arccos(np.minimum(dots, np.float32(1))))
    return total


def _search() -> list[dict[str, Any]]:
    """The best transition points of a library by itself, in blocks; its memory in a process."""
    done = subprocess.run(
        [sys.executable, "-m", "tests.benchmarks.motion"],
        cwd=Path(__file__).resolve().parents[2], check=True, capture_output=True, text=True,
    )  # fmt: skip
    seconds, rival, megabytes = json.loads(done.stdout)
    name = f"best transition points of {LIBRARY} × {LIBRARY} frames"
    whole = LIBRARY**2 * 4 / 1e6
    return [
        _row(name, seconds, "NumPy arccos, float32, angles alone", rival, unit="s"),
        _row(f"{name}: memory", megabytes, "the whole matrix, float32", whole, unit="MB",
             faster=1.0),
    ]  # fmt: skip


def _searched() -> tuple[float, float, float]:
    """Seconds of a search, of NumPy's arccos on the same blocks, and megabytes at the peak."""
    motions = [unroll(walker(seed), 0, LIBRARY // 20)[0][: LIBRARY // 20] for seed in range(20)]
    search(motions[:1], motions[:1])
    before = _peak(reset=True)
    start = time.perf_counter()
    search(motions, motions)
    seconds = time.perf_counter() - start
    megabytes = _peak() - before
    joints, weights = weighted_joints(motions[0].skeleton, "wang")
    frames = np.concatenate([motion.rotations[:, joints] for motion in motions])
    blocks = [frames[first : first + BLOCK] for first in range(0, LIBRARY, BLOCK)]
    start = time.perf_counter()
    for p, q in itertools.product(blocks, blocks):
        _numpy_single(p, q, weights)
    return seconds, time.perf_counter() - start, megabytes


def _peak(reset: bool = False) -> float:
    """Megabytes of memory that this process has held at most, from now on if reset (Linux)."""
    if reset:
        Path("/proc/self/clear_refs").write_text("5")
    status = Path("/proc/self/status").read_text()
    return int(status.partition("VmHWM:")[2].split()[0]) / 1000


def _lengths() -> list[dict[str, Any]]:
    """All sixty lengths of every pair, against sixty times the distance matrix."""
    p, q, weights = _rotations()
    distance = fused_angles(p, q, weights)
    ours = _median(lambda: lengths_of(distance, "start-end"), 5)
    matrix = _median(lambda: fused_angles(p, q, weights))
    name = "optimal length of every (i, j), 60 lengths, 2000 × 2000"
    return [_row(name, ours, "60 × the distance matrix", 60 * matrix, faster=1.0)]


def _transition() -> list[dict[str, Any]]:
    """Thirty frames with alignment, slerp, foot lock and forward kinematics of the blend."""
    a, b = (_with_fingers(unroll(walker(seed), 60, 120)[0]) for seed in (0, 1))
    i, j, frames = 90, 125, 30

    def ours() -> object:
        done = transition(a, b, i, j, frames=frames, foot_lock=True)
        blend = slice(done.mixed[0], done.mixed[1] + 1)
        motion = done.motion
        return forward(motion.skeleton, motion.rotations[blend], motion.root[blend])

    name = f"transition of 30 frames, {JOINTS} joints: align, slerp, foot lock, kinematics"
    return [
        _row(name, _median(ours, 100), "the same blend by scipy's Slerp", _median(
            lambda: _scipy_blend(a, b, i, j, frames), 5), faster=80.0)
    ]  # fmt: skip


def _with_fingers(motion: Motion) -> Motion:
    """The motion with joints at its hands until it has as many as captured bodies have."""
    body = motion.skeleton
    hands = body.role("left_wrist" if "left_wrist" in body.roles else "left_elbow",
                      "right_wrist" if "right_wrist" in body.roles else "right_elbow")  # fmt: skip
    more = JOINTS - len(body)
    parents = np.array([hands[n % 2] for n in range(more)])
    skeleton = Skeleton(
        (*body.names, *(f"finger{n}" for n in range(more))),
        np.concatenate([body.parents, parents]),
        np.vstack([body.offsets, np.full((more, 3), 0.03)]),
        body.end_parents,
        body.end_offsets,
        body.roles,
    )
    still = np.tile(quat.IDENTITY, (len(motion), more, 1))
    return Motion(skeleton, np.concatenate([motion.rotations, still], axis=1), motion.root)


def _scipy_blend(a: Motion, b: Motion, i: int, j: int, frames: int) -> object:
    """Slerp of every joint of every frame, as scipy offers it; no alignment, lock or kinematics."""
    from scipy.spatial.transform import Rotation, Slerp

    blended = []
    for t in range(1, frames + 1):
        pairs = zip(a.rotations[i + t - 1], b.rotations[j - frames + t], strict=True)
        for pair in pairs:
            ends = Rotation.from_quat(np.array(pair), scalar_first=True)
            blended.append(Slerp([0.0, 1.0], ends)(t / (frames + 1)))
    return blended


if __name__ == "__main__":
    print(json.dumps(_searched()))
