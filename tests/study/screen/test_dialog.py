"""The dialog for who takes part, by real keys, and the session that follows it."""

import csv
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from stimuli.motion import Library, write_walker
from stimuli.sets import build
from study.protocol.sets import set_spec
from study.screen.virtual import virtual_screen
from study.trials.reading import parse_protocol
from tests.study.screen.test_window import PROTOCOL, press, press_until

ROOT = Path(__file__).resolve().parents[3]
TITLE = "Segue: who"


@pytest.fixture(scope="module")
def screen() -> Iterator[str]:
    with virtual_screen(800, 600) as display:
        yield display


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dialog")
    for seed in (0, 1):
        write_walker(folder / "motions", seed)
    library = Library([folder / "motions"])
    build(set_spec(parse_protocol(PROTOCOL), None, library), library, folder / "set", workers=1)
    (folder / "p.toml").write_text(PROTOCOL)
    return folder


def session(place: Path, **environment: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "study.cli", "run", "p.toml", "--stimuli", "set", "--seed", "4",
         "--windowed"],
        cwd=place, env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
        stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def shown_within(process: subprocess.Popen[str], known: set[str]) -> str:
    """The window of a dialog that was not there before."""
    end = time.monotonic() + 60
    while process.poll() is None and time.monotonic() < end:
        found = subprocess.run(["xdotool", "search", "--name", TITLE],
                               capture_output=True, text=True, check=False)  # fmt: skip
        if new := set(found.stdout.split()) - known:
            time.sleep(0.5)  # until it takes keys
            return new.pop()
        time.sleep(0.1)
    raise AssertionError("no dialog came")


def enter(*words: str) -> None:
    """Type into the fields one after the other; `v` is the key that goes down in a list."""
    for n, word in enumerate(words):
        if n:
            press("Tab")
        if set(word) == {"v"}:
            press(*(["Down"] * len(word)))
        elif word:
            subprocess.run(["xdotool", "type", "--delay", "40", word], check=True)


def told_by(process: subprocess.Popen[str]) -> str:
    assert process.stderr is not None
    with process.stderr as stream:
        told = stream.read()
    process.wait()
    return told


def test_a_session_begins_with_who_it_is(place: Path, screen: str) -> None:
    process = session(place)
    first = shown_within(process, set())
    enter("p 01", "34", "v", "v", "vv", "v")
    press("Return")
    shown_within(process, {first})  # which says that no ID has a blank
    press("ctrl+a")
    enter("p07")
    press("Return")

    def over() -> bool:
        return process.poll() is not None

    press_until(process, ("space", "2"), over)
    told = told_by(process)
    assert process.returncode == 0, told
    with (place / "data/participants.tsv").open(encoding="utf-8", newline="") as stream:
        (person,) = csv.DictReader(stream, delimiter="\t")
    assert person == {
        "participant_id": "sub-p07", "age": "34", "sex": "female", "vision": "yes",
        "naive": "no", "animation_experience": "yes", "observer": "human", "comments": "n/a",
    }  # fmt: skip
    assert (place / "data/sub-p07/beh/sub-p07_task-windowtest_run-1_beh.tsv").is_file()


def test_who_cancels_begins_nothing(place: Path, screen: str) -> None:
    before: Any = sorted(place.rglob("*"))
    process = session(place)
    shown_within(process, set())
    press("Escape")
    assert told_by(process) == "left before the session began\n"
    assert process.returncode == 1
    assert sorted(place.rglob("*")) == before


def test_where_no_dialog_opens_it_is_said_what_to_give(place: Path, screen: str) -> None:
    process = session(place, QT_QPA_PLATFORM="nowhere")
    told = told_by(process)
    assert process.returncode == 2
    assert told.startswith("segue run: --participant: found none, and no dialog opens")
    assert told.endswith("give it\n")
    assert len(told.splitlines()) == 1
    process = session(place, DISPLAY="")
    assert told_by(process) == (
        "segue run: --participant: expected an ID, found none and no screen to ask for it on\n"
    )
    assert process.returncode == 2
