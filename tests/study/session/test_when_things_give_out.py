"""Disks that fill, screens that go away or were never there, machines without OpenGL."""

import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from stimuli.errors import MachineError
from stimuli.motion import Library, write_walker
from stimuli.sets import build, load_manifest
from study.protocol.sets import set_spec
from study.record.table import COMMON, create
from study.screen.virtual import virtual_screen
from study.trials.reading import parse_protocol
from tests.conftest import of_cases

ROOT = Path(__file__).resolve().parents[3]
SHARED = ROOT.parent / "shared" / "cases" / "session"
PROTOCOL = """
name = "frail"
task = "preference"
methods = ["fixed", "cut"]
[stimuli]
seconds = 2
motions = [{ name = "m", from = "a", to = "b" }, { name = "n", from = "b", to = "a" }]
[sets.generated]
a = { clip = "generated-walker-0", frame = 3 }
b = { clip = "generated-walker-1", frame = 5 }
[appearance]
width = 160
height = 120
background = [0.5, 0.4, 0.3]
[presentation]
gap = 0
void = "never"
[rehearsal]
seconds = 0.6
[trials]
repeats = 10
[observer]
prefer = { fixed = 0.8, cut = 0.2 }
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A protocol with its set rendered where `segue run` looks for it."""
    folder = tmp_path_factory.mktemp("frail")
    (folder / "p.toml").write_text(PROTOCOL)
    for seed in (0, 1):
        write_walker(folder / "motions", seed)
    library = Library([folder / "motions"])
    spec = set_spec(parse_protocol(PROTOCOL), None, library)
    made = build(spec, library, folder / "stimulus-sets" / "frail", workers=1)
    read = load_manifest(made.directory)
    assert made.background == read.background
    assert [clip.document for clip in made.clips] == [clip.document for clip in read.clips]
    return folder


@pytest.fixture
def screen() -> Iterator[str]:
    with virtual_screen(640, 480) as display:
        yield display


def segue(place: Path, *words: str, **environment: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "study.cli", *words], cwd=place, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT), "SEGUE_MOTIONS": str(place / "motions"),
             **environment},
    )  # fmt: skip


def run(place: Path, person: str, *options: str) -> subprocess.Popen[str]:
    return segue(
        place, "run", "p.toml", "--participant", person, "--observer", "simulated", "--windowed",
        "--seed", "3", *options,
    )  # fmt: skip


def table_of(place: Path, person: str) -> Path:
    return place / f"data/sub-{person}/beh/sub-{person}_task-frail_run-1_beh.tsv"


def said(process: subprocess.Popen[str]) -> str:
    """What a command that stopped said, without the X library's chatter, notes and durations."""
    _, told = process.communicate(timeout=120)
    lines = [line for line in told.splitlines() if not line.startswith("Xlib:")]
    assert "Traceback" not in told
    return "\n".join(lines[-2:])


def wait_for_rows(path: Path, count: int, process: subprocess.Popen[str]) -> None:
    end = time.monotonic() + 60
    while time.monotonic() < end and process.poll() is None:
        if path.exists() and len(path.read_text().splitlines()) > count:
            return
        time.sleep(0.05)
    raise AssertionError(process.communicate())


def test_a_disk_that_fills_costs_one_answer_and_the_session_goes_on(
    place: Path, screen: str
) -> None:
    process = run(place, "full", "--pace", "20")
    table = table_of(place, "full")
    wait_for_rows(table, 2, process)
    kept = table.read_bytes()
    table.unlink()
    table.symlink_to("/dev/full")
    told = said(process)
    assert process.returncode == 1
    assert "could not be written: No space left on device" in told
    assert "all answers before it are kept" in told
    assert "See that there is room to write, and go on with: segue run p.toml" in told
    table.unlink()
    table.write_bytes(kept)
    again = run(place, "full", "--pace", "20", "--resume")
    assert again.wait(timeout=200) == 0
    again.communicate()
    assert table.read_bytes().startswith(kept)
    assert len(table.read_text().splitlines()) == 21


def test_a_row_that_cannot_be_written_names_its_trial(tmp_path: Path) -> None:
    record = create(tmp_path / "sub-x_task-y_run-1_beh.tsv", tuple(COMMON), {})
    record.path.unlink()
    record.path.symlink_to("/dev/full")
    with pytest.raises(MachineError, match=r"_beh\.tsv: trial 7 could not be written: No space"):
        record.append({"trial": 7})


def test_a_screen_that_goes_away_keeps_the_answers(place: Path) -> None:
    with virtual_screen(640, 480):
        process = run(place, "lost")
        wait_for_rows(table_of(place, "lost"), 1, process)
        os.kill(newest_server(), signal.SIGKILL)
        told = said(process)
    assert process.returncode == 1
    assert "the screen went away; all answers so far are kept in data/sub-lost" in told
    assert told.endswith(
        "segue run p.toml --participant lost --data data --observer simulated --windowed --resume"
    )
    assert not json.loads(table_of(place, "lost").with_suffix(".json").read_text())["Finished"]


def newest_server() -> int:
    """The process of the X server that this process started last."""
    mine = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            name, _, rest = status.read_text().partition("(")[2].partition(") ")
            if name == "Xvfb" and int(rest.split()[1]) == os.getpid():
                mine.append(int(status.parent.name))
    return max(mine)


@pytest.mark.parametrize("screen_number", ["1", "-1"])
def test_a_screen_that_is_not_there_is_refused(
    place: Path, screen: str, screen_number: str
) -> None:
    process = run(place, "nowhere", "--screen", screen_number)
    told = said(process)
    assert process.returncode == 2
    assert f"--screen {screen_number}: expected a screen that is there, found screen 0" in told
    assert "leave --screen out" in told
    assert not table_of(place, "nowhere").exists()


def test_without_a_device_for_opengl_the_packages_are_named(place: Path, tmp_path: Path) -> None:
    process = segue(
        place, "render", "p.toml", "--out", str(tmp_path / "set"), LIBGL_ALWAYS_SOFTWARE="1",
        __EGL_VENDOR_LIBRARY_DIRS=str(tmp_path),
    )  # fmt: skip
    told = said(process)
    assert process.returncode == 1
    assert "expected a device for OpenGL" in told
    assert "libegl-mesa0" in told
    assert not list((tmp_path / "set").rglob("*.mkv"))


def small_files() -> None:
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))


def test_no_room_for_a_clip_leaves_nothing_half_written(place: Path, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "study.cli", "render", "p.toml", "--out", str(tmp_path / "set")],
        cwd=place, env={**os.environ, "PYTHONPATH": str(ROOT), "SEGUE_MOTIONS": "motions"},
        preexec_fn=small_files, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 1
    assert "expected room for a clip, found none" in done.stderr
    assert "Make room on that disk, and run it again" in done.stderr
    assert [path.name for path in (tmp_path / "set/clips").iterdir()] == []


def flips_of(place: Path, person: str) -> list[list[str]]:
    log = place / f"data/sourcedata/sub-{person}/beh/sub-{person}_task-frail_run-1_flips.tsv"
    return [line.split("\t") for line in log.read_text().splitlines()[1:]]


def test_a_rehearsal_shows_the_middle_of_the_studys_clips(place: Path, screen: str) -> None:
    process = run(place, "whole", "--rehearsal")
    said(process)
    assert process.returncode == 0
    facts = json.loads(table_of(place, "whole").with_suffix(".json").read_text())
    manifest = load_manifest(place / "stimulus-sets/frail")
    assert facts["StimulusSetHash"] == manifest.hash
    assert facts["Rehearsal"]
    assert {int(row[1]) for row in flips_of(place, "whole")} == set(range(18))
    assert not (place / "stimulus-sets/frail-rehearsal").exists()


def test_a_rehearsal_without_the_studys_clips_makes_its_own_once(
    place: Path, screen: str, tmp_path: Path
) -> None:
    (tmp_path / "p.toml").write_text(PROTOCOL)
    (tmp_path / "motions").symlink_to(place / "motions")
    hashes = []
    for person in ("first", "later"):
        process = run(tmp_path, person, "--rehearsal", "--pace", "10")
        assert process.wait(timeout=120) == 0, process.communicate()
        process.communicate()
        facts = json.loads(table_of(tmp_path, person).with_suffix(".json").read_text())
        hashes.append(facts["StimulusSetHash"])
    made = load_manifest(tmp_path / "stimulus-sets/frail-rehearsal")
    assert hashes == [made.hash] * 2
    assert made.seconds == 0.6


@pytest.mark.parametrize(
    ("case", "line", "word"),
    of_cases(
        [
            ("keys_arrow.toml", 19, 'no key is called "left arrow" (did you mean left?)'),
            ("keys_empty.toml", 19, "expected the name of a key, found an empty one"),
        ]
    ),
)
def test_keys_that_nobody_can_press_are_refused(
    place: Path, case: str, line: int, word: str
) -> None:
    process = segue(place, "run", str(SHARED / case), "--participant", "p01")
    told = said(process)
    assert process.returncode == 2
    assert word in told or f"{case}:{line}" in told


def test_a_clip_that_was_cut_short_is_named_before_it_is_shown(
    place: Path, screen: str, tmp_path: Path
) -> None:
    (tmp_path / "p.toml").write_text(PROTOCOL)
    shutil.copytree(place / "stimulus-sets", tmp_path / "stimulus-sets")
    for clip in (tmp_path / "stimulus-sets/frail/clips").glob("*.mov"):
        clip.write_bytes(clip.read_bytes()[: clip.stat().st_size // 2])
    told = said(process := run(tmp_path, "short"))
    assert process.returncode == 2
    assert ".mov: expected" in told
    assert "cut short or exchanged" in told
    assert "segue render" in told


def test_another_clip_of_the_same_length_is_named_before_it_is_shown(
    place: Path, screen: str, tmp_path: Path
) -> None:
    (tmp_path / "p.toml").write_text(PROTOCOL)
    shutil.copytree(place / "stimulus-sets", tmp_path / "stimulus-sets")
    for clip in (tmp_path / "stimulus-sets/frail/clips").glob("*.mov"):
        content = bytearray(clip.read_bytes())
        content[len(content) // 2] ^= 1
        clip.write_bytes(content)
    told = said(process := run(tmp_path, "swapped"))
    assert process.returncode == 2
    assert ".mov: expected the clip that the set was built with, found another file" in told
    assert "segue render" in told


@pytest.mark.parametrize(
    ("display", "word"), [(":4711", "DISPLAY=:4711"), ("", "DISPLAY is not set")]
)
def test_a_display_that_does_not_answer_is_named(place: Path, display: str, word: str) -> None:
    process = segue(
        place, "run", "p.toml", "--participant", "p1", "--observer", "simulated", DISPLAY=display,
        WAYLAND_DISPLAY="wayland-0",
    )  # fmt: skip
    assert word in said(process)
    assert process.returncode in (1, 2)


@pytest.mark.parametrize(
    ("table", "word"),
    [(b"id\tage\n1\t2\n", "a column participant_id"), (b"participant_id\n\xe9\n", "UTF-8")],
)
def test_a_table_of_participants_that_is_none_is_refused_beforehand(
    place: Path, tmp_path: Path, table: bytes, word: str
) -> None:
    (tmp_path / "participants.tsv").write_bytes(table)
    process = run(place, "p1", "--data", str(tmp_path))
    assert word in said(process)
    assert process.returncode == 2


@pytest.mark.parametrize(
    "options", [("--pace", "nan"), ("--pace", "inf"), ("--seed", "-1"), ("--data", "p.toml")]
)
def test_numbers_and_places_that_cannot_be_are_refused(
    place: Path, options: tuple[str, str]
) -> None:
    process = segue(
        place, "run", "p.toml", "--participant", "q1", "--observer", "simulated", *options,
        DISPLAY=":4711",
    )  # fmt: skip
    told = said(process)
    assert "--debug" not in told
    assert "expected" in told
    assert process.returncode in (1, 2)


def test_simulated_people_are_nobodys_twins(place: Path, tmp_path: Path) -> None:
    (tmp_path / "sub-SIM001").mkdir()
    process = segue(place, "simulate", "p.toml", "--participants", "1", "--data", str(tmp_path))
    said(process)
    assert process.returncode == 0
    assert sorted(path.name for path in tmp_path.glob("sub-*")) == ["sub-SIM001", "sub-sim002"]
