"""The README's commands, run as they are printed, in its order."""

import csv
import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from study.screen.virtual import virtual_screen

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
LABELS = """from_clip,from_frame,to_clip,to_frame,good
humanoid3d_walk,10,humanoid3d_run,5,1
humanoid3d_walk,30,humanoid3d_run,20,0
humanoid3d_walk,20,humanoid3d_run,12,1
humanoid3d_run,12,humanoid3d_walk,12,0
"""
TABLE = "level,correct,total\n" + "".join(
    f"{level},{right},20\n" for level, right in ((1, 10), (2, 12), (4, 15), (6, 18), (8, 20))
)
OLD = "subj,stim,acc\n" + "".join(
    f"s{person},{level},{int(trial < right)}\n"
    for person in (1, 2, 3)
    for level, right in ((1, 10), (2, 12), (4, 15), (6, 18), (8, 20))
    for trial in range(20)
)
MEANT = {
    "A:i": "humanoid3d_walk:3", "B:j": "humanoid3d_run:5", "A": "humanoid3d_walk",
    "B": "humanoid3d_run", "FILE.bvh": "joined.bvh", "LABELS.csv": "labels.csv",
    "TABLE.csv": "table.csv", "PROTOCOL": "study-four", "COMMAND": "fit", "DIR": ".",
    "FILE": "captured.json",
}  # fmt: skip
# What a test adds to a command that is printed without: a person, or less of the same work.
ADDED = {
    "segue run mine.toml --participant p01": ["--observer", "simulated", "--pace", "20"],
    "segue render jnd-center": ["--dry-run"],
    "segue certify PROTOCOL": ["--sets", "4"],
    "segue simulate": ["study-four", "--participants", "2", "--data", "simulated"],
    "segue blend A B --method cut": ["--out", "cut.bvh"],
}
ALONE = ("doctor", "motions")  # what else is printed without arguments is a name in a sentence
LEFT_OUT = {
    "segue run jnd-center …", "segue run PROTOCOL",  # want a set that takes minutes
    "segue graph build --scheduler ADDRESS",
}  # fmt: skip


def printed() -> list[str]:
    """Every command of Segue that the README prints, in blocks and between backticks."""
    blocks = re.findall(r"^    (?:\.venv/bin/)?(segue [^#\n]*)", README, re.MULTILINE)
    inline = re.findall(r"`(?:\.venv/bin/)?(segue\s[^`]*)`", README)
    commands = [re.sub(r"\s+", " ", text).strip() for text in (*blocks, *inline)]
    return [text for text in dict.fromkeys(commands) if text not in LEFT_OUT]


def words(command: str) -> list[str]:
    given = [MEANT.get(word, word) for word in command.split()[1:]]
    named = len(given) == 1 and given[0] not in ALONE and command not in ADDED
    added = ["--help"] if named else ADDED.get(command, [])
    return [sys.executable, "-m", "study.cli", *given, *added]


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory, sample_motions: Path) -> Path:
    folder = tmp_path_factory.mktemp("readme")
    block = re.search(r"Save this as `mine.toml`:\n\n((?:    .*\n|\n)+)", README)
    observer = re.search(r"\n((?:    .*\n)*    \[observer\]\n(?:    .*\n)+)", README)
    assert block is not None
    assert observer is not None
    text = "\n".join(line[4:] for line in (block[1] + observer[1]).splitlines())
    (folder / "mine.toml").write_text(text)
    wanted = re.search(r"what a motion is to do as `walk.toml`:\n\n((?:    .*\n)+)", README)
    assert wanted is not None
    (folder / "walk.toml").write_text("".join(line[4:] + "\n" for line in wanted[1].splitlines()))
    (folder / "labels.csv").write_text(LABELS)
    (folder / "table.csv").write_text(TABLE)
    (folder / "old.csv").write_text(OLD)
    walk = next(sample_motions.glob("humanoid3d_walk.*"))
    (folder / "captured.json").write_bytes(walk.read_bytes())
    return folder


@pytest.fixture(scope="module")
def screen() -> Iterator[str]:
    with virtual_screen(800, 600) as display:
        yield display


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(ROOT)}


@pytest.mark.parametrize("command", printed())
def test_a_command_of_the_readme_does_what_it_says(place: Path, screen: str, command: str) -> None:
    process = subprocess.Popen(
        words(command), cwd=place, env=environment(), stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
    )  # fmt: skip
    if "--rehearsal" in command:
        answer_all(process)
    told, _ = process.communicate(timeout=300)
    assert process.returncode == 0, told
    assert "Traceback" not in told


def answer_all(process: subprocess.Popen[str]) -> None:
    """Somebody who presses keys until the session is over."""
    end = time.monotonic() + 120
    while process.poll() is None and time.monotonic() < end:
        for key in ("space", "1"):
            subprocess.run(["xdotool", "keydown", key], check=True)
            time.sleep(0.08)
            subprocess.run(["xdotool", "keyup", key], check=True)
        time.sleep(0.2)


def counted(record: Path) -> int:
    """Trials that count: a busy machine shows some late, which are asked again."""
    with record.open(encoding="utf-8", newline="") as stream:
        return sum(row["void"] == "0" for row in csv.DictReader(stream, delimiter="\t"))


def test_the_study_of_ones_own_leaves_a_record_and_a_report(place: Path) -> None:
    assert (place / "data/derivatives/segue/report.html").is_file()
    rehearsed = place / "data/sub-p00/beh/sub-p00_task-mine_run-1_beh.tsv"
    assert counted(rehearsed) == 1
    session = place / "data/sub-p01/beh/sub-p01_task-mine_run-1_beh.tsv"
    assert counted(session) == 10
