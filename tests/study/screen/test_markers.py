"""Markers of a session, received by another process over a real stream."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from stimuli.errors import InputError
from stimuli.motion import Library, write_walker
from stimuli.sets import build
from study.protocol.sets import set_spec
from study.screen import markers
from study.screen.virtual import virtual_screen
from study.trials.reading import parse_protocol
from tests.study.screen.test_window import PROTOCOL, press_until

ROOT = Path(__file__).resolve().parents[3]
MARKED = PROTOCOL.replace("[presentation]", "[presentation]\nmarkers = true")
RECEIVER = """
import json, sys
import pylsl, pylsl.util
found = pylsl.resolve_byprop("source_id", sys.argv[1], timeout=60)
inlet = pylsl.StreamInlet(found[0], recover=False)
inlet.open_stream(timeout=20)
print("open", flush=True)
told = []
try:
    while (held := inlet.pull_sample(timeout=60))[0] is not None:
        told.append((held[1], held[0][0]))
except pylsl.util.LostError:
    pass
print(json.dumps({"name": found[0].name(), "type": found[0].type(), "told": told}))
"""


@pytest.fixture(scope="module")
def screen() -> Iterator[str]:
    with virtual_screen(640, 480) as display:
        yield display


def test_a_recorder_receives_each_event_when_it_was_flipped(screen: str, tmp_path: Path) -> None:
    for seed in (0, 1):
        write_walker(tmp_path / "motions", seed)
    library = Library([tmp_path / "motions"])
    build(set_spec(parse_protocol(MARKED), None, library), library, tmp_path / "set", workers=1)
    (tmp_path / "p.toml").write_text(MARKED)
    (tmp_path / "lsl.cfg").write_text("[multicast]\nResolveScope = machine\n[log]\nlevel = -3\n")
    environment = {**os.environ, "LSLAPICFG": str(tmp_path / "lsl.cfg"), "PYTHONPATH": str(ROOT)}
    session = subprocess.Popen(
        [sys.executable, "-m", "study.cli", "run", "p.toml", "--participant", "p01", "--stimuli",
         "set", "--seed", "4", "--windowed"],
        cwd=tmp_path, env=environment, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    receiver = subprocess.Popen(
        [sys.executable, "-c", RECEIVER, "segue-sub-p01_task-windowtest_run-1"],
        env=environment, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert receiver.stdout is not None
    assert session.stderr is not None
    assert receiver.stdout.readline() == "open\n"
    press_until(session, ("space", "2"), lambda: session.poll() is not None)
    with session.stderr:
        assert session.returncode == 0, session.stderr.read()
    with receiver.stdout:
        heard = json.loads(receiver.stdout.read())
    receiver.wait()
    assert (heard["name"], heard["type"]) == ("Segue", "Markers")
    stem = "sub-p01_task-windowtest_run-1"
    header, *lines = (tmp_path / f"data/sub-p01/beh/{stem}_beh.tsv").read_text().splitlines()
    rows = [dict(zip(header.split("\t"), line.split("\t"), strict=True)) for line in lines]
    assert len(rows) == 4
    expected = [
        f"trial {row['trial']} {what}" for row in rows
        for what in ("start", "screen 1", "screen 2", "question", f"answer {row['response']}")
    ]  # fmt: skip
    stamps = {text: stamp for stamp, text in heard["told"]}
    assert [text for _, text in heard["told"]] == expected
    asked = [stamp for text, stamp in stamps.items() if " answer " not in text]
    assert sorted(asked) == asked
    first = stamps["trial 1 screen 1"] - float(rows[0]["onset"])
    for row in rows:  # LSL's clock goes as the session's does
        shown = stamps[f"trial {row['trial']} screen 1"]
        assert abs(shown - first - float(row["onset"])) < 0.05
        # an answer may come before the question is seen, but not before the clips
        answered = stamps[f"trial {row['trial']} answer {row['response']}"]
        assert answered > stamps[f"trial {row['trial']} screen 2"]


def test_without_the_library_it_is_said_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pylsl", None)
    with pytest.raises(InputError, match=r"segue\[lsl\]"):
        markers.open_markers("x")
    markers.unmarked("nobody hears it", time.monotonic())
