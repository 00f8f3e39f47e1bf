"""Whole stimulus sets: rendered, and read back, against programs that people write for it."""

import json
import os
import re
import statistics
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from tests.benchmarks.rows import row

RUNS = 3
CORES = 2
ROOT = Path(__file__).resolve().parents[2]
SMALL = "[appearance]\nwidth = 640\nheight = 480\n"
ALL, DRAWN = 22, 2  # clips of the set, and those that the straightforward program draws


def rows() -> list[dict[str, Any]]:
    """The set of jnd-center, its memory, and one of its clips read back before a trial."""
    from stimuli.sets import load_manifest

    with TemporaryDirectory() as folder:
        place = Path(folder)
        _generated(place / "motions")
        seconds, megabytes = _set(place)
        rival = _run("rival", place) * ALL / DRAWN
        entry = load_manifest(place / "set-0").clips[0]
        fast, slow = _run("read", entry.path), _run("read", _archived(entry, place))
    return [
        row(f"the jnd-center set, {ALL} clips, 640 × 480, {CORES} cores", seconds, "s",
            "pyrender: a node a part, a new scene a frame, FFV1", rival, faster=12.0),
        row("a process that renders it, or plans it, at most", megabytes, "MB", felt=600),
        row("a clip of six seconds read back and checked", fast, "ms",
            "FFV1, its frames stacked", slow, faster=4.0),
    ]  # fmt: skip


def _generated(folder: Path) -> None:
    from stimuli.motion import write_walker

    for seed in range(3):
        write_walker(folder, seed)


def _set(place: Path) -> tuple[float, float]:
    """Seconds of `segue render` for a set that is not there, and its largest process's memory."""
    from study.protocol.protocol import shipped

    protocol = place / "jnd-center.toml"
    text = shipped()["jnd-center"].read_text(encoding="utf-8")
    text = re.sub(r"(?m)^(height|shape) = .*\n", "", text).replace("[appearance]\n", SMALL)
    protocol.write_text(text, encoding="utf-8")
    seconds, megabytes = [], 0.0
    for run in range(RUNS):
        done = subprocess.run(
            [sys.executable, "-m", "tests.benchmarks.sets", "set", str(place), str(run)],
            cwd=ROOT, check=True, capture_output=True, text=True,
        )  # fmt: skip
        taken, most = json.loads(done.stdout.splitlines()[-1])
        seconds.append(taken)
        megabytes = max(megabytes, most)
    return statistics.median(seconds), megabytes


def _rendered(place: Path, run: str) -> tuple[float, float]:
    import resource

    command = [
        sys.executable, "-m", "study.cli", "render", str(place / "jnd-center.toml"), "--set",
        "generated", "--motions", str(place / "motions"), "--workers", str(CORES), "--out",
        str(place / f"set-{run}"),
    ]  # fmt: skip
    start = time.perf_counter()
    subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    seconds = time.perf_counter() - start
    return seconds, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024


def _run(name: str, *words: Path) -> float:
    """The median of several runs, each in a process of its own."""
    from stimuli.sets.drawing import ENVIRONMENT

    values = [
        json.loads(
            subprocess.run(
                [sys.executable, "-m", "tests.benchmarks.sets", name, *map(str, words)],
                cwd=ROOT, env=os.environ | ENVIRONMENT, check=True, capture_output=True, text=True,
            ).stdout.splitlines()[-1]
        )
        for _ in range(RUNS)
    ]  # fmt: skip
    return float(statistics.median(values))


def _archived(entry: Any, place: Path) -> Path:
    """The same clip as FFV1."""
    from stimuli.render import write_video
    from stimuli.sets.video import read_clip

    path = place / "archived.mkv"
    write_video(path, read_clip(entry), 30)
    return path


def _read(path: Path) -> float:
    """Milliseconds to have a clip's frames, as a session has them: checked, in one array."""
    from types import SimpleNamespace

    import av

    from stimuli.files import sha256
    from stimuli.sets.video import read_clip

    def ours() -> None:
        read_clip(entry)

    def rival() -> None:
        with av.open(str(path)) as container:
            np.stack([frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)])

    entry = SimpleNamespace(path=path, frames=180, document={"file_sha256": sha256(path)})
    read = rival if path.suffix == ".mkv" else ours
    read()
    start = time.perf_counter()
    read()
    return (time.perf_counter() - start) * 1000


def _rival(place: Path) -> float:
    """Seconds for some clips drawn and encoded frame by frame in one process."""
    from stimuli.motion import Library
    from stimuli.render import write_video
    from stimuli.sets.group import plan_groups
    from study.protocol.sets import set_spec
    from study.trials.reading import load_protocol
    from tests.benchmarks.rival import straightforward

    library = Library([place / "motions"])
    protocol = load_protocol(str(place / "jnd-center.toml"))
    groups = plan_groups(set_spec(protocol, "generated", library), library)
    picture_of = straightforward()
    clips = [(clip.laid_out.motion, group.camera) for group in groups for clip in group.clips[:1]]
    start = time.perf_counter()
    for n, (motion, camera) in enumerate(clips[:DRAWN]):
        write_video(place / f"rival-{n}.mkv", picture_of(motion, camera), 30)
    return time.perf_counter() - start


def main(name: str, *words: str) -> None:
    """Print one measurement."""
    place = Path(words[0])
    if name == "set":
        print(json.dumps(_rendered(place, words[1])), flush=True)
    else:
        print({"rival": _rival, "read": _read}[name](place), flush=True)
    os._exit(0)  # a context is not worth a tidy end here


if __name__ == "__main__":
    main(*sys.argv[1:])
