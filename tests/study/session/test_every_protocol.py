"""Every task and every shipped protocol in the real window, to its end."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from stimuli.motion import Library, write_walker
from stimuli.sets import build
from study.protocol.battery import battery_of
from study.protocol.protocol import shipped
from study.protocol.sets import set_spec
from study.screen.virtual import virtual_screen
from study.trials.reading import load_protocol, parse_protocol

ROOT = Path(__file__).resolve().parents[3]
HOLD_SECONDS = 0.08
SHORT = """
[stimuli]
seconds = 0.5
motions = [{ name = "m", from = "a", to = "b" }]
[sets.generated]
a = { clip = "generated-walker-0", frame = 3 }
b = { clip = "generated-walker-1", frame = 5 }
[appearance]
width = 160
height = 120
[presentation]
gap = 0.1
void = "never"
"""
TASKS = {
    "preference": ('methods = ["fixed", "cut"]', "", "2"),
    "natural": ('methods = ["fixed", "cut"]', "", "1"),
    "rating": (
        'methods = ["fixed", "cut"]',
        '[questions]\neach = [{ name = "e", text = "Realistic?", low = "not", high = "very" }]\n'
        'compared = [{ name = "c", text = "Which was better?", low = "first", high = "second" }]\n',
        "4",
    ),
}  # odd pairs are answered by key in tests/study/screen/test_window.py


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Protocols of three tasks, which show the same clips."""
    folder = tmp_path_factory.mktemp("tasks")
    for seed in (0, 1):
        write_walker(folder / "motions", seed)
    for task, (methods, questions, _) in TASKS.items():
        text = f'name = "short"\ntask = "{task}"\n{methods}\n{SHORT}{questions}'
        (folder / f"{task}.toml").write_text(text)
    library = Library([folder / "motions"])
    spec = set_spec(parse_protocol((folder / "natural.toml").read_text()), None, library)
    build(spec, library, folder / "set", workers=1)
    return folder


@pytest.fixture(scope="module")
def screen() -> Iterator[str]:
    with virtual_screen(1024, 768) as display:
        yield display


def run(folder: Path, protocol: str, person: str, *options: str) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [sys.executable, "-m", "study.cli", "run", protocol, "--participant", person, "--seed", "4",
         *options],
        cwd=folder, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL,
        text=True, env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip


def pressed_to_the_end(process: "subprocess.Popen[str]", *keys: str) -> str:
    """Press real keys in turn, each held for a moment, until the session is over; what it said."""
    end = time.monotonic() + 240
    while process.poll() is None and time.monotonic() < end:
        for key in keys:
            subprocess.run(["xdotool", "keydown", key], check=True)
            time.sleep(HOLD_SECONDS)
            subprocess.run(["xdotool", "keyup", key], check=True)
        time.sleep(0.1)
    _, told = process.communicate(timeout=10)
    return told


def finished(folder: Path, person: str) -> list[tuple[dict[str, object], list[dict[str, str]]]]:
    """Each sidecar and the rows of its table."""
    held = []
    for table in sorted((folder / "data" / f"sub-{person}" / "beh").glob("*_beh.tsv")):
        header, *lines = table.read_text().splitlines()
        rows = [dict(zip(header.split("\t"), line.split("\t"), strict=True)) for line in lines]
        held.append((json.loads(table.with_suffix(".json").read_text()), rows))
    return held


@pytest.mark.parametrize("task", TASKS)
def test_a_session_of_each_task_is_answered_by_real_keys(
    task: str, place: Path, screen: str
) -> None:
    key = TASKS[task][2]
    process = run(place, f"{task}.toml", task, "--stimuli", "set", "--windowed")
    told = pressed_to_the_end(process, "space", key)
    assert process.returncode == 0, told
    ((facts, rows),) = finished(place, task)
    assert facts["Finished"]
    assert len(rows) == {"preference": 1, "natural": 2, "rating": 3}[task]
    response = {"preference": "second", "natural": "natural", "rating": "4"}[task]
    assert {row["response"] for row in rows} == {response}
    assert all(0 <= float(row["response_time"]) < 60 for row in rows)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(shipped()))
def test_every_shipped_protocol_runs_to_its_end(
    name: str, tmp_path: Path, screen: str, sample_motions: Path
) -> None:
    """A rehearsal before a simulated observer, of clips rendered from the sample motions."""
    options = ("--rehearsal", "--observer", "simulated", "--pace", "20", "--motions",
               str(sample_motions))  # fmt: skip
    process = run(tmp_path, name, "p1", *options)
    _, told = process.communicate(timeout=500)
    assert process.returncode == 0, told
    ((facts, rows),) = finished(tmp_path, "p1")
    assert facts["Finished"]
    assert facts["Rehearsal"]
    assert facts["TaskName"] == name
    assert rows
    assert {row["late_frames"] for row in rows} == {"n/a"}
    assert {row["void"] for row in rows} == {"0"}


@pytest.mark.slow
def test_a_battery_runs_to_its_end(tmp_path: Path, screen: str, sample_motions: Path) -> None:
    options = ("--rehearsal", "--observer", "simulated", "--pace", "20", "--motions",
               str(sample_motions))  # fmt: skip
    process = run(tmp_path, "battery", "p1", *options)
    _, told = process.communicate(timeout=500)
    assert process.returncode == 0, told
    held = finished(tmp_path, "p1")
    battery = battery_of("battery")
    assert battery is not None
    members = {load_protocol(name).name for name in battery.protocols}
    assert {facts["TaskName"] for facts, _ in held} == members
    assert all(facts["Finished"] for facts, _ in held)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["jnd-center", "study-one", "weights"])
def test_a_shipped_protocol_of_each_task_is_answered_by_real_keys(
    name: str, tmp_path: Path, screen: str, sample_motions: Path
) -> None:
    process = run(tmp_path, name, "p1", "--rehearsal", "--motions", str(sample_motions))
    told = pressed_to_the_end(process, "space", "1")
    assert process.returncode == 0, told
    ((facts, rows),) = finished(tmp_path, "p1")
    assert facts["Finished"]
    assert rows
    assert {row["response"] for row in rows} <= {"1", "first"}
