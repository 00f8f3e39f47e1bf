"""A lab's user lacks much: no priority, no home, no shared memory, no devices, a strict umask."""

import json
import os
import shutil
import stat
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from stimuli.motion import write_walker
from study.screen.priority import may_have_priority
from study.screen.virtual import virtual_screen

ROOT = Path(__file__).resolve().parents[3]
PROTOCOL = """
name = "poor"
task = "preference"
methods = ["fixed", "cut"]
[stimuli]
seconds = 0.5
motions = [{ name = "m", from = "a", to = "b" }]
[sets.generated]
a = { clip = "generated-walker-0", frame = 3 }
b = { clip = "generated-walker-1", frame = 5 }
[appearance]
width = 160
height = 120
[trials]
repeats = 2
[observer]
prefer = { fixed = 0.8, cut = 0.2 }
"""
# Nothing in /dev/shm can be written, no input device is seen, and xauth is no program.
HIDDEN = (
    "mount -t tmpfs -o ro none /dev/shm && "
    "if [ -d /dev/input ]; then mount -t tmpfs -o ro none /dev/input; fi && "
    'for xauth in $(which -a xauth); do mount --bind /dev/null "$xauth"; done && '
)
LESS = "setpriv --bounding-set=-sys_nice,-dac_override --inh-caps=-sys_nice,-dac_override "
MISSING = ("DBUS_SESSION_BUS_ADDRESS", "XDG_RUNTIME_DIR", "XAUTHORITY", "XDG_DATA_HOME")


def can_hide() -> bool:
    tried = ["unshare", "--mount", "sh", "-c", f"{HIDDEN} true"]
    return (
        bool(shutil.which("unshare")) and subprocess.run(tried, capture_output=True).returncode == 0
    )


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("poor")
    (folder / "p.toml").write_text(PROTOCOL)
    for seed in (0, 1):
        write_walker(folder / "motions", seed)
    return folder


def poor(place: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """A command of somebody who has what this machine lets us take away."""
    environment = {key: value for key, value in os.environ.items() if key not in MISSING}
    environment |= {
        "HOME": "/proc/nowhere", "PYTHONPATH": str(ROOT), "SEGUE_MOTIONS": str(place / "motions")
    }  # fmt: skip
    hide = HIDDEN if can_hide() else ""
    less = LESS if may_have_priority() else ""
    script = f'umask 077 && {hide} exec {less} "$@"'
    start = ["unshare", "--mount"] if hide else []
    return subprocess.run(
        [*start, "sh", "-c", script, "poor", sys.executable, "-m", "study.cli", *words],
        cwd=place, env=environment, capture_output=True, text=True, timeout=200,
        stdin=subprocess.DEVNULL,
    )  # fmt: skip


def test_a_study_is_rendered_run_simulated_and_reported(place: Path) -> None:
    with virtual_screen(640, 480):
        told = [
            poor(place, *words)
            for words in (
                ["doctor"],
                ["render", "p.toml"],
                ["run", "p.toml", "--participant", "p01", "--observer", "simulated",
                 "--pace", "10", "--windowed"],
                ["simulate", "p.toml", "--participants", "45"],
                ["report", "data"],
            )
        ]  # fmt: skip
    for done in told:
        assert done.returncode == 0, done.stderr
        assert "Traceback" not in done.stderr
    assert "99-psychtoolboxlimits.conf" in told[0].stdout
    assert "99-psychtoolboxlimits.conf" in told[2].stderr
    assert "matplotlib" not in told[4].stderr.lower()
    facts = json.loads(next((place / "data/sub-p01/beh").glob("*.json")).read_text())
    assert facts["Finished"]
    assert facts["Display"]["keyboard"] == "x-server"
    assert len(list((place / "data").glob("sub-sim*"))) == 45
    assert (place / "data/derivatives/segue/report.html").is_file()
    assert shown_to_others(place / "data") == shown_to_others(place / "stimulus-sets") == []


def shown_to_others(folder: Path) -> Sequence[Path]:
    return [path for path in folder.rglob("*") if stat.S_IMODE(path.stat().st_mode) & 0o077]


def test_without_shared_semaphores_one_core_does_it_and_says_so(place: Path) -> None:
    if not can_hide():
        pytest.skip("this user may not hide /dev/shm from a process")
    done = poor(place, "simulate", "p.toml", "--participants", "45", "--data", "alone")
    assert done.returncode == 0, done.stderr
    assert "one core alone" in done.stderr
