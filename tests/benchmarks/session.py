"""A session in a real window, at pace 1: what a participant waits between an answer and a clip."""

import csv
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from stimuli.motion import write_walker
from study.screen.virtual import virtual_screen
from tests.benchmarks.rows import row

ROOT = Path(__file__).resolve().parents[2]
TRIALS, SECONDS, WAIT, OVER = 10, 6.0, 0.15, 1.1
PROTOCOL = f"""
name = "waiting"
task = "preference"
methods = ["fixed", "cut"]
[stimuli]
seconds = {SECONDS}
motions = [{{ name = "m", from = "a", to = "b" }}]
[sets.generated]
a = {{ clip = "generated-walker-0", frame = 3 }}
b = {{ clip = "generated-walker-1", frame = 5 }}
[appearance]
width = 640
height = 480
[presentation]
gap = 0.0
void = "never"
[trials]
repeats = {TRIALS}
[observer]
prefer = {{ fixed = 0.8, cut = 0.2 }}
"""


def rows() -> list[dict[str, Any]]:
    """Seconds between an answer and the next first frame; the session beside its clips."""
    with tempfile.TemporaryDirectory(prefix="segue-") as folder:
        table, flips = _session(Path(folder))
    first, last = ({trial: edge(flips[trial]) for trial in flips} for edge in (min, max))
    waits, shown = [], 0.0
    for n in range(1, TRIALS):
        answered = last[n] + float(table[n - 1]["response_time"])
        waits.append(first[n + 1] - answered)
        shown += 2 * SECONDS + float(table[n - 1]["response_time"])
    over = (first[TRIALS] - first[1]) / shown
    wait = float(np.median(waits))
    return [
        row("answer to first frame (640 × 480, six seconds)", wait, "s", felt=WAIT),
        row("session beside its clips and answers", over, "×", felt=OVER),
    ]


def _session(place: Path) -> tuple[list[dict[str, str]], dict[int, list[float]]]:
    """A simulated observer's session: its rows, and when frames of each trial were flipped."""
    for seed in (0, 1):
        write_walker(place / "motions", seed)
    (place / "waiting.toml").write_text(PROTOCOL, encoding="utf-8")
    own = {"SEGUE_MOTIONS": str(place / "motions"), "PYTHONPATH": str(ROOT)}
    with virtual_screen(1280, 800):
        for words in (
            ["render", "waiting.toml"],
            ["run", "waiting.toml", "--participant", "p1", "--observer", "simulated",
             "--seed", "1"],
        ):  # fmt: skip
            subprocess.run([sys.executable, "-m", "study.cli", *words], cwd=place, check=True,
                           env=os.environ | own, capture_output=True)  # fmt: skip
    record = next((place / "data").glob("sub-p1/beh/*_beh.tsv"))
    assert json.loads(record.with_suffix(".json").read_text())["Finished"]
    log = next((place / "data" / "sourcedata").rglob("*_flips.tsv"))
    flips: dict[int, list[float]] = {}
    for line in _table(log):
        if line["unix_time"] != "n/a":
            began = float(line["unix_time"])
        if line["trial"].startswith("trial "):
            number = int(line["trial"].removeprefix("trial "))
            flips.setdefault(number, []).append(began + float(line["flip"]))
    return _table(record), flips


def _table(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream, delimiter="\t"))
