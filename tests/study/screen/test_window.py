"""The real window under Xvfb: a human's keys, a simulated observer, a kill, what is shown."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stimuli.motion import Library
from study.protocol.sets import set_spec
from study.screen.priority import may_have_priority
from study.screen.virtual import virtual_screen
from study.session.simulation import rows as session_rows
from study.trials.observers import Simulated
from study.trials.plan import make_plan
from study.trials.reading import parse_protocol

ROOT = Path(__file__).resolve().parents[3]
HOLD_SECONDS = 0.08
KEYBOARDS = ("ptb", "x-server")
PROTOCOL = """
name = "window-test"
task = "odd-pair"
[stimuli]
specification = "center-aligned"
reference = 10
lengths = [2, 18]
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
[staircase]
rule = "wang"
stop = { trials = 2 }
[observer]
shorter = -4
longer = 4
slope = 1.0
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A protocol and its stimulus set, of generated motion."""
    from stimuli.motion import write_walker
    from stimuli.sets import build

    folder = tmp_path_factory.mktemp("window")
    (folder / "p.toml").write_text(PROTOCOL)
    for seed in (0, 1):
        write_walker(folder / "motions", seed)
    library = Library([folder / "motions"])
    build(set_spec(parse_protocol(PROTOCOL), None, library), library, folder / "set", workers=1)
    return folder


@pytest.fixture(scope="module")
def screen() -> Iterator[str]:
    with virtual_screen(640, 480) as display:
        yield display


def command(place: Path, participant: str, *options: str) -> list[str]:
    return [
        sys.executable, "-m", "study.cli", "run", str(place / "p.toml"), "--participant",
        participant, "--data", str(place / "data"), "--stimuli", str(place / "set"), "--seed", "4",
        "--windowed", *options,
    ]  # fmt: skip


def as_user(keyboard: str) -> list[str]:
    """What makes a command that of a user who gets this keyboard; skips where none can be made."""
    if keyboard == "ptb":
        if not may_have_priority():
            pytest.skip("this user may not raise a thread's priority, which psychtoolbox needs")
        return []
    without = ["setpriv", "--bounding-set=-sys_nice", "--inh-caps=-sys_nice"]
    return without if may_have_priority() else []


def record(place: Path, participant: str, run: int = 1) -> list[dict[str, str]]:
    stem = f"sub-{participant}_task-windowtest_run-{run}_beh.tsv"
    path = place / "data" / f"sub-{participant}" / "beh" / stem
    if not path.exists():
        return []
    header, *lines = path.read_text().splitlines()
    return [dict(zip(header.split("\t"), line.split("\t"), strict=False)) for line in lines]


def sidecar(place: Path, participant: str) -> dict[str, object]:
    stem = f"sub-{participant}_task-windowtest_run-1_beh.json"
    return json.loads((place / "data" / f"sub-{participant}" / "beh" / stem).read_text())


def press(*keys: str) -> None:
    """Hold each key long enough to be seen."""
    for key in keys:
        subprocess.run(["xdotool", "keydown", key], check=True)
        time.sleep(HOLD_SECONDS)
        subprocess.run(["xdotool", "keyup", key], check=True)


def press_until(process: subprocess.Popen[Any], keys: tuple[str, ...], done) -> None:
    """Press keys in turn until `done()`, as somebody eager would."""
    end = time.monotonic() + 60
    while not done() and process.poll() is None and time.monotonic() < end:
        press(*keys)
        time.sleep(0.1)
    assert done(), "the session did not take the keys"


@pytest.mark.parametrize("keyboard", KEYBOARDS)
def test_a_person_answers_by_key(place: Path, screen: str, keyboard: str) -> None:
    person = keyboard.replace("-", "")
    process = subprocess.Popen(
        [*as_user(keyboard), *command(place, person)],
        cwd=ROOT, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    press_until(process, ("space", "2"), lambda: process.poll() is not None)
    assert process.stderr is not None
    with process.stderr:
        told = process.stderr.read()
    assert process.returncode == 0, told
    assert ("99-psychtoolboxlimits.conf" in told) == (keyboard == "x-server")
    table = record(place, person)
    assert {row["response"] for row in table} == {"2"}
    times = [float(row["response_time"]) for row in table]
    assert all(0 <= seconds < 5 for seconds in times)
    facts = sidecar(place, person)
    assert facts["Finished"]
    assert facts["Display"]["keyboard"] == keyboard
    (timing,) = facts["KeyTiming"]
    assert timing["keyboard"] == keyboard
    if keyboard == "x-server":
        assert all(0 < jitter < 2 for jitter in timing["keyboard_jitter_ms"])
        assert all(0 <= bound < 2 for bound in timing["keyboard_uncertainty_ms"])
    hashes = {row[c] for row in table for c in ("clip_a", "clip_b")}
    kept = {path.stem for path in (place / "data" / "stimuli").glob("*.json")}
    assert hashes <= kept


def test_a_simulated_observer_sits_before_the_same_window(place: Path, screen: str) -> None:
    done = subprocess.run(
        command(place, "sim", "--observer", "simulated", "--pace", "4"),
        cwd=ROOT, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    facts = sidecar(place, "sim")
    assert facts["Pace"] == 4.0
    assert facts["Observer"] == "simulated"
    onsets = np.array([float(row["onset"]) for row in record(place, "sim")])
    assert len(onsets) == 4
    assert (np.diff(onsets) > 0).all()
    flips = place / "data/sourcedata/sub-sim/beh/sub-sim_task-windowtest_run-1_flips.tsv"
    shown = [line.split("\t") for line in flips.read_text().splitlines()[1:]]
    last_frames = {(line[0], line[1]): int(line[2]) for line in shown}
    assert len(last_frames) == 8
    assert set(last_frames.values()) == {14}


def test_a_session_killed_three_times_loses_no_answer_and_goes_on(place: Path, screen: str) -> None:
    """Killed at random moments of a trial; its rows are those of a session that nobody killed."""
    plan = make_plan(parse_protocol(PROTOCOL), {"m": 10}, 4)
    whole = list(session_rows(plan, Simulated(lambda content, draw: "1")))
    moments = np.random.default_rng(3).uniform(0.0, 1.2, 3)
    kept: list[dict[str, str]] = []
    for times, moment in enumerate(moments):
        resume = ["--resume"] if times else []
        process = subprocess.Popen(
            command(place, "killed", *resume), cwd=ROOT, stdin=subprocess.DEVNULL
        )
        wanted = times + 1
        press_until(process, ("space", "1"), lambda n=wanted: len(record(place, "killed")) >= n)
        time.sleep(moment)
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        before, kept = kept, record(place, "killed")
        assert len(kept) >= wanted
        assert kept[: len(before)] == before
        assert not sidecar(place, "killed")["Finished"]
    refused = subprocess.run(
        command(place, "killed"), cwd=ROOT, capture_output=True, text=True,
        stdin=subprocess.DEVNULL, timeout=60,
    )  # fmt: skip
    assert refused.returncode == 2
    assert "--resume" in refused.stderr
    process = subprocess.Popen(
        command(place, "killed", "--resume"), cwd=ROOT, stdin=subprocess.DEVNULL
    )
    press_until(process, ("space", "1"), lambda: process.poll() is not None)
    assert process.returncode == 0
    after = record(place, "killed")
    assert after[: len(kept)] == kept
    same = ("trial", "phase", "track", "length", "odd_pair", "odd_position", "correct", "response")
    assert [[row[key] for key in same] for row in after] == [
        [str(row[key]) for key in same] for row in whole
    ]
    onsets = [float(row["onset"]) for row in after]
    assert onsets == sorted(onsets)


def test_leaving_keeps_the_record(place: Path, screen: str) -> None:
    process = subprocess.Popen(
        command(place, "left"), cwd=ROOT, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE
    )
    press_until(process, ("space", "1"), lambda: len(record(place, "left")) >= 1)
    press_until(process, ("Escape",), lambda: process.poll() is not None)
    assert process.returncode == 1
    assert process.stderr is not None
    with suppress(BrokenPipeError), process.stderr:
        assert b"--resume" in process.stderr.read()
    assert not sidecar(place, "left")["Finished"]


LEAVE = """
import subprocess, threading, time
import numpy as np
from study.protocol.schema import Keys
from study.screen.clips import Held
from study.screen.window import Look, WindowStage
from study.trials.prompt import Prompt
from study.session.stage import Interrupted, SessionLeft
from study.trials.trial import ClipKey
frames = np.zeros((90, 60, 80, 3), np.uint8)
look = Look(Keys(), 0.0, 0.6, 30.0, (127, 127, 127))
stage = WindowStage(look, Held({ClipKey("a"): frames}), None, windowed=True)
def escape():
    time.sleep(1.0)
    subprocess.run(["xdotool", "keydown", "Escape"], check=True)
    time.sleep(0.1)
    subprocess.run(["xdotool", "keyup", "Escape"], check=True)
threading.Thread(target=escape).start()
try:
    stage.present(((ClipKey("a"),),), "t")
except Interrupted:
    print("interrupted")
def press(key):
    time.sleep(0.5)
    subprocess.run(["xdotool", "keydown", key], check=True)
    time.sleep(0.1)
    subprocess.run(["xdotool", "keyup", key], check=True)
threading.Thread(target=press, args=("space",)).start()
print(stage.pause())
threading.Thread(target=press, args=("Escape",)).start()
try:
    stage.pause()
except SessionLeft:
    print("left")
threading.Thread(target=press, args=("Escape",)).start()
print(stage.thank("Thank you."))
stage.close()
"""


@pytest.mark.parametrize("keyboard", KEYBOARDS)
def test_leaving_while_a_clip_plays_is_not_lost(screen: str, keyboard: str) -> None:
    assert said_by(LEAVE, keyboard) == "interrupted\nNone\nleft\nNone\n"


TAP = """
import subprocess, time
from study.protocol.schema import Keys
from study.screen.clips import Held
from study.screen.window import Look, WindowStage
from study.trials.prompt import Prompt
look = Look(Keys(), 0.0, 0.6, 30.0, (127, 127, 127))
stage = WindowStage(look, Held({}), None, windowed=True)
def press(key):
    subprocess.run(["xdotool", "keydown", key], check=True)
    time.sleep(0.05)
def let_go(key):
    subprocess.run(["xdotool", "keyup", key], check=True)
    time.sleep(0.05)
def draw_slowly(text, low=None):
    let_go("1")
    press("2")
    let_go("2")
press("1")
stage._text = draw_slowly
stage._keyboard.listen()
stage._shown = True
print(stage.ask(Prompt("?", {"1": "1", "2": "2"}), 2.0, None).response)
stage.close()
"""


@pytest.mark.parametrize("keyboard", KEYBOARDS)
def test_a_tap_before_the_question_is_drawn_counts(screen: str, keyboard: str) -> None:
    """A key let go again by then counts; one pressed before the last frame does not."""
    assert said_by(TAP, keyboard) == "2\n"


HELD = """
import subprocess, time
from study.protocol.schema import Keys
from study.screen.clips import Held
from study.screen.window import Look, WindowStage
from study.trials.prompt import Prompt
look = Look(Keys(), 0.0, 0.6, 30.0, (127, 127, 127))
stage = WindowStage(look, Held({}), None, windowed=True)
keyboard = stage._keyboard
stage._text("?")
keyboard.listen()
fitting = []
for n in range(4):
    before = keyboard.since()
    subprocess.run(["xdotool", "keydown", "space"], check=True)
    after = keyboard.since()
    time.sleep(1.2 if n == 0 else 0.08)
    subprocess.run(["xdotool", "keyup", "space"], check=True)
    time.sleep(0.08)
    fitting.append((before, after))
time.sleep(0.5)
presses = keyboard.pressed(["space", "1"])
print(len(presses), all(a - 2e-3 <= p.seconds <= b + 2e-3 for p, (a, b) in zip(presses, fitting)))
print(keyboard.pressed(["space"]))
stage.close()
"""


@pytest.mark.parametrize("keyboard", KEYBOARDS)
def test_a_key_is_timed_when_it_went_down_not_when_it_was_read(screen: str, keyboard: str) -> None:
    """Read half a second late; a held key, which repeats itself, is one press."""
    assert said_by(HELD, keyboard) == "4 True\n[]\n"


LAYOUT = """
import subprocess, time
from study.protocol.schema import Keys
from study.screen.clips import Held
from study.screen.window import Look, WindowStage
from study.trials.prompt import Prompt
look = Look(Keys(), 0.0, 0.6, 30.0, (127, 127, 127))
for layout in ("de", "fr", "ru,us", "us"):
    subprocess.run(["setxkbmap", layout], check=True)
    stage = WindowStage(look, Held({}), None, windowed=True)
    stage._text("?")
    stage._keyboard.measure()
    stage._keyboard.listen()
    keys = ["z", "y", "a", "1", "space"]
    for key in keys:
        subprocess.run(["xdotool", "keydown", key], check=True)
        time.sleep(0.08)
        subprocess.run(["xdotool", "keyup", key], check=True)
        time.sleep(0.05)
    print(*[press.name for press in stage._keyboard.pressed(keys)])
    stage.close()
"""


@pytest.mark.parametrize("keyboard", KEYBOARDS)
def test_a_key_is_called_what_is_printed_on_it(screen: str, keyboard: str) -> None:
    if shutil.which("setxkbmap") is None:
        pytest.skip("no setxkbmap to change the keyboard's layout")
    assert said_by(LAYOUT, keyboard).splitlines() == ["z y a 1 space"] * 4


PLACES = """
import subprocess, time
from Xlib import X
from Xlib.display import Display
from Xlib.ext import xtest
from study.protocol.schema import Keys
from study.screen.clips import Held
from study.screen.window import Look, WindowStage
from study.trials.prompt import Prompt
subprocess.run(["setxkbmap", "gr"], check=True)
look = Look(Keys(), 0.0, 0.6, 30.0, (127, 127, 127))
stage = WindowStage(look, Held({}), None, windowed=True)
stage._text("?")
stage._keyboard.listen()
stage._shown = True
hand = Display()
for code in (41, 44, 10, 65):  # where an American keyboard has f, j, 1 and the space bar
    for kind in (X.KeyPress, X.KeyRelease):
        xtest.fake_input(hand, kind, code)
        hand.sync()
        time.sleep(0.08)
print(*[press.name for press in stage._keyboard.pressed(["f", "j", "1", "space"])])
subprocess.run(["setxkbmap", "us"], check=True)
stage.close()
"""


@pytest.mark.parametrize("keyboard", KEYBOARDS)
def test_letters_that_no_layout_has_keep_their_places(screen: str, keyboard: str) -> None:
    if shutil.which("setxkbmap") is None:
        pytest.skip("no setxkbmap to change the keyboard's layout")
    assert said_by(PLACES, keyboard) == "f j 1 space\n"


def said_by(script: str, keyboard: str) -> str:
    done = subprocess.run(
        [*as_user(keyboard), sys.executable, "-c", script],
        cwd=ROOT, capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_bad_participant_leaves_everything_alone(place: Path, screen: str) -> None:
    before = sorted(path for path in place.rglob("*"))
    done = subprocess.run(
        command(place, "../../x"), cwd=ROOT, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) <= 2
    assert "letters and digits" in done.stderr
    assert sorted(path for path in place.rglob("*")) == before


PICTURE = """
import sys
from pathlib import Path
import numpy as np
from study.protocol.schema import Keys
from study.screen.clips import Held
from study.screen.window import Look, WindowStage
from study.trials.prompt import Prompt
from study.trials.trial import ClipKey
frames = {
    "a": np.full((5, 60, 80, 3), (200, 40, 40), np.uint8),
    "b": np.full((5, 60, 80, 3), (40, 40, 200), np.uint8),
}
frames["a"][:, :10] = (250, 250, 0)
look = Look(
    Keys(), 0.0, 0.6, 30.0, (127, 127, 127), simulated=True, pace=5.0, enlarge=True
)
clips = Held({ClipKey(name): clip for name, clip in frames.items()})
stage = WindowStage(look, clips, None, windowed=True)
pictures = []
flip = stage._flips.flip
def kept():
    pictures.append(np.asarray(stage.picture()))
    return flip()
stage._flips.flip = kept
stage.present(((ClipKey("a"), ClipKey("b")),), "t")
np.save(sys.argv[1], pictures[-1])
stage.close()
"""


def test_clips_lie_side_by_side_upright_on_the_background(tmp_path: Path, screen: str) -> None:
    subprocess.run([sys.executable, "-c", PICTURE, str(tmp_path / "p.npy")], cwd=ROOT, check=True)
    picture = np.load(tmp_path / "p.npy")[..., :3]
    height, width = picture.shape[:2]
    row = picture[height // 2].astype(int)
    assert row[0].tolist() == [127, 127, 127]
    assert row[width // 4].tolist() == [200, 40, 40]
    assert row[3 * width // 4].tolist() == [40, 40, 200]
    assert row[width // 2].tolist() == [127, 127, 127]
    column = picture[:, width // 4].tolist()
    yellow, red = column.index([250, 250, 0]), column.index([200, 40, 40])
    assert yellow < red


PAINTED = """
import json, sys
from pathlib import Path
import numpy as np
from stimuli.render import write_video
from study.protocol.schema import Keys
from study.screen.clips import ClipFile, Decoder
from study.screen.window import Look, WindowStage
from study.trials.trial import ClipKey
A, B = ClipKey("a"), ClipKey("b")
files = {}
for key, first in ((A, 10), (B, 140)):
    path = Path(sys.argv[1]) / f"{key.motion}.mov"
    values = np.arange(first, first + 90, dtype=np.uint8)
    write_video(path, np.broadcast_to(values[:, None, None, None], (90, 60, 80, 3)), 30.0)
    files[key] = ClipFile(path, None, 90, 0, 90, 80, 60)
look = Look(Keys(), 0.1, 0.6, 30.0, (127, 127, 127), simulated=True, enlarge=True,
            photodiode="top-right")
log = Path(sys.argv[1]) / "flips.tsv"
stage = WindowStage(look, Decoder(files.__getitem__), log, windowed=True)
width, height = (int(v) for v in stage._window.size)
flip, shown = stage._window.flip, []
def kept():
    picture = np.asarray(stage.picture())
    shown.append([int(picture[height // 2, x, 0]) for x in (width // 4, 3 * width // 4)])
    shown[-1].append(int(picture[5, width - 5, 0]))
    flip()
stage._window.flip = kept
late = [stage.present(((A, B), (B, B)), f"trial {n}").late for n in (1, 2)]
facts = stage.display()["photodiode"]
stage.close()
print(json.dumps({"shown": shown, "late": late, "facts": facts}))
"""


def test_every_frame_of_a_clip_appears_once_and_in_order(tmp_path: Path, screen: str) -> None:
    """Read back from frames that are painted with their number, at pace 1, in two trials.

    The square of the photodiode turns with each of them; the log has every flip, in order.
    """
    done = subprocess.run(
        [sys.executable, "-c", PAINTED, str(tmp_path)],
        cwd=ROOT, capture_output=True, text=True, check=True, timeout=120,
    )  # fmt: skip
    told = json.loads(done.stdout)
    a, b = list(range(10, 100)), list(range(140, 230))
    screens = [list(zip(a, b, strict=True)), list(zip(b, b, strict=True))] * 2
    flipped = [(*pair, patch) for *pair, patch in told["shown"]]
    shown = [seen for seen, _ in groupby(flipped)]  # a frame is there until the next is due
    announced = (127, 127, 0)  # the background, where a screen is announced, and the square off
    clips = [seen for seen in shown if seen != announced]
    assert [(left, right) for left, right, _ in clips] == [pair for s in screens for pair in s]
    assert [patch for *_, patch in clips] == [255, 0] * (len(clips) // 2)
    assert told["facts"] == {"corner": "top-right", "side": 29}
    header, *lines = (tmp_path / "flips.tsv").read_text().splitlines()
    log = [dict(zip(header.split("\t"), line.split("\t"), strict=True)) for line in lines]
    assert len(log) == sum(seen != announced for seen in flipped)
    first = [10, 140] * 2
    pictures = (seen[0] for seen in flipped if seen != announced)
    for (key, rows), start in zip(
        groupby(log, lambda row: (row["trial"], row["screen"])), first, strict=True
    ):
        held = list(rows)
        assert key[0] in ("trial 1", "trial 2")
        assert [int(row["frame"]) + start for row in held] == [next(pictures) for _ in held]
        new = [row for row in held if row["due"] != "n/a"]
        assert [int(row["frame"]) for row in new] == list(range(90))
        assert [float(row["due"]) for row in new] == pytest.approx(np.arange(90) / 30, abs=1e-4)
        assert [row["unix_time"] != "n/a" for row in held] == [True] + [False] * (len(held) - 1)
    late = [len(frames) for trial in told["late"] for frames in trial]
    screens_of = groupby(log, lambda row: (row["trial"], row["screen"]))
    behind = [
        np.array([float(row["flip"]) - float(row["due"]) for row in rows if row["due"] != "n/a"])
        for _, rows in screens_of
    ]
    for count, seconds in zip(late, behind, strict=True):  # logged to a tenth of a millisecond
        assert (seconds > 1 / 120 + 2e-4).sum() <= count <= (seconds > 1 / 120 - 2e-4).sum()
