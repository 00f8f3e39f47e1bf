"""The commands motions, cost, length, blend and weights, as a person calls them."""

import argparse
import csv
import importlib
import json
import os
import subprocess
import sys

import numpy as np
import pytest

from stimuli.motion import Motion, load_clip, unroll, walker, write_walker
from stimuli.motion.formats.bvh_write import write_bvh
from stimuli.ties import first_least
from stimuli.transition import METHODS, SPECIFICATIONS, cost_matrix
from study.cli import blend, common, main


@pytest.fixture
def library(tmp_path):
    """A directory with three generated walkers."""
    for seed in (0, 1, 2):
        write_walker(tmp_path / "lib", seed)
    return tmp_path / "lib"


@pytest.fixture
def call(capsys, library, tmp_path, monkeypatch):
    """Calls the command line on the walkers; returns exit code, output and errors.

    In a folder where whoever runs this may write.
    """
    monkeypatch.chdir(tmp_path)

    def run(*words):
        code = main([*map(str, words), "--motions", str(library)])
        said = capsys.readouterr()
        return code, said.out, said.err

    return run


def test_motions_lists_clips_and_tells_refusals(call, library):
    (library / "bad.bvh").write_text("HIERARCHY\nROOT a\n{\n")
    code, out, err = call("motions", "--json")
    rows = {row["name"]: row for row in json.loads(out)}
    assert code == 0
    assert "bad.bvh" in err
    assert set(rows["bad"]) == {"name", "path", "error"}
    walker = rows["generated-walker-0"]
    for key in ("name", "path", "format", "frames", "fps", "seconds", "joints", "scale", "up",
                "roles_missing", "warnings"):  # fmt: skip
        assert key in walker
    assert (walker["format"], walker["joints"], walker["up"]) == ("deepmimic", 15, "Y")
    code, out, err = call("motions")
    assert "generated-walker-2" in out
    assert call("motions", library / "bad.bvh")[0] == 2
    assert call("motions", library / "none.bvh")[0] == 2


def test_length_tells_every_method(call):
    points = ("generated-walker-0:5", "generated-walker-1:20")
    code, out, _ = call("length", *points, "--json")
    found = json.loads(out)
    assert code == 0
    assert found["fixed"] == {"frames": 10}
    assert len(found["geodesic"]["costs"]) == 60
    costs = [cost for cost in found["geodesic"]["costs"] if cost is not None]
    assert min(costs) == found["geodesic"]["costs"][found["geodesic"]["frames"] - 1]
    assert {"frames", "joint", "difference", "speed", "clamped"} <= set(found["velocity"])
    assert {"from_frames", "to_frames", "cost"} <= set(found["timewarp"])
    code, out, _ = call("length", *points, "--specification", "center-aligned")
    assert "timewarp" in out


def test_length_draws_its_curves(call, tmp_path):
    picture = tmp_path / "length.png"
    call("length", "generated-walker-0:5", "generated-walker-1:20", "--out", picture)
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("method", ["cut", "fixed", "geodesic", "velocity", "timewarp",
                                    "inertialization", "dead-blending"])  # fmt: skip
@pytest.mark.parametrize("specification", ["start-end", "center-aligned"])
def test_blend_writes_a_bvh_that_reads_back(call, tmp_path, method, specification):
    out = tmp_path / "joined.bvh"
    code, said, _ = call(
        "blend", "generated-walker-0:5", "generated-walker-1:20", "--method", method,
        "--specification", specification, "--out", out, "--json",
    )  # fmt: skip
    assert code == 0
    told = json.loads(said)
    clip = load_clip(out)
    assert (clip.frames, clip.fps, clip.joints) == (told["total_frames"], 30.0, 15)
    assert told["frames"] == (0 if method == "cut" else told["frames"])


def test_blend_with_and_without_the_foot_lock(call, tmp_path):
    held, free = tmp_path / "held.bvh", tmp_path / "free.bvh"
    words = ("blend", "generated-walker-0:5", "generated-walker-1:30", "--frames", 20)
    assert call(*words, "--out", held)[0] == call(*words, "--no-foot-lock", "--out", free)[0] == 0
    assert held.read_bytes() != free.read_bytes()


def test_cost_tells_minima_and_saves_the_matrix(call, tmp_path):
    npz, picture = tmp_path / "c.npz", tmp_path / "c.png"
    code, out, _ = call("cost", "generated-walker-0", "generated-walker-1", "--json",
                        "--npz", npz, "--out", picture)  # fmt: skip
    found, saved = json.loads(out), np.load(npz)
    assert code == 0
    assert found["frames"] == list(saved["cost"].shape)
    assert found["minimum"]["cost"] == saved["cost"].min()
    assert found["minimum"] == found["local_minima"][0]
    assert np.allclose(saved["probability"].sum(axis=1), 1)
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert "cheapest first" in call("cost", "generated-walker-0", "generated-walker-1")[1]


def test_cost_searches_whole_directories(call, library):
    code, out, _ = call("cost", library, library, "--count", 7, "--json")
    found = json.loads(out)["local_minima"]
    assert code == 0
    assert len(found) == 7
    costs = [point["cost"] for point in found]
    assert costs == sorted(costs)


def test_weights_from_labels(call, tmp_path):
    rng = np.random.default_rng(0)
    path = tmp_path / "labels.csv"
    with path.open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(["from_clip", "from_frame", "to_clip", "to_frame", "good"])
        for n in range(16):
            i = int(rng.integers(2, 28))
            j = i if n % 2 else (i + 12) % 28
            writer.writerow(["generated-walker-0", i, "generated-walker-1", j, n % 2])
    out = tmp_path / "w.toml"
    code, said, _ = call("weights", path, "--json", "--out", out)
    found = json.loads(said)
    assert code == 0
    assert max(found["parts"].values()) == 1
    assert found["weights"]["left_knee"] == found["weights"]["right_knee"]
    assert len(found["leave_one_out"]) == 16
    assert call("cost", "generated-walker-0", "generated-walker-1", "--weights", out)[0] == 0
    path.write_text(path.read_text() + "nobody,1,generated-walker-1,2,1\na,b,c,d,e\n")
    code, _, err = call("weights", path)
    assert code == 2
    assert "line 18" in err
    assert "line 19" in err


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("length", "generated-walker-0:999", "generated-walker-1:2"), "0 to"),
        (("length", "generated-walker-0", "generated-walker-1:2"), "CLIP:FRAME"),
        (("length", "nobody:1", "generated-walker-1:2"), "nobody"),
        (("blend", "generated-walker-0:3", "generated-walker-1:2", "--out", "x.doc"), ".bvh"),
        (("blend", "generated-walker-0:3", "generated-walker-1:2", "--out", "x.bvh", "--method",
          "magic"), "magic"),
        (("cost", "generated-walker-0", "generated-walker-1", "--weights", "no.toml"), "no.toml"),
        (("weights", "no.csv"), "no.csv"),
    ],
)  # fmt: skip
def test_bad_input_is_one_or_two_lines_and_exit_code_2(call, words, told):
    code, out, err = call(*words)
    assert code == 2
    assert out == ""
    assert told in err
    lines = [line for line in err.splitlines() if not line.startswith("/")]
    assert len(lines) <= 2


@pytest.mark.parametrize("frame", ["²", "١", "1_0", "-1", "9" * 5000])
def test_a_frame_is_a_whole_number_in_plain_digits(call, frame):
    code, out, err = call("length", f"generated-walker-0:{frame}", "generated-walker-1:2")
    assert (code, out) == (2, "")
    assert "CLIP:FRAME" in err
    assert len(err.splitlines()) == 1


def test_one_bad_file_never_aborts_the_list(call, library):
    bvh = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Zrotation\n}\nMOTION\n"
    (library / "digits.bvh").write_text(f"{bvh}Frames: {'9' * 5000}\nFrame Time: 0.03\n1\n")
    (library / "power.bvh").write_text(f"{bvh}Frames: ²\nFrame Time: 0.03\n1\n")
    (library / "slow.bvh").write_text(f"{bvh}Frames: 2\nFrame Time: 900\n1\n1\n")
    (library / "deep.json").write_text(json.dumps({"Frames": [[[1]] * 44]}))
    (library / "07.asf").mkdir()
    (library / "07_01.amc").write_text("1\nroot 0\n")
    code, out, err = call("motions", "--json")
    rows = {row["name"]: row for row in json.loads(out)}
    assert code == 0
    for name in ("digits", "power", "slow", "deep", "07_01"):
        assert "expected" in rows[name]["error"]
        assert rows[name]["error"] in err
    assert "error" not in rows["generated-walker-1"]


def test_a_fault_of_overrides_is_told_once(call, library):
    (library / "overrides.toml").write_text("scale = true\n")
    code, _, err = call("motions")
    assert code == 2
    assert err.count("overrides.toml: scale: expected") == 1


def test_a_cut_without_frames_is_the_cheapest_with_room(call, tmp_path):
    long = unroll(walker(0), 0, 300)[0]
    for name in ("one", "other"):
        write_bvh(Motion(long.skeleton, long.rotations, long.root), tmp_path / f"{name}.bvh")
    out = tmp_path / "cut.bvh"
    words = ("blend", "one", "other", "--method", "cut", "--motions", tmp_path, "--json")
    told = json.loads(call(*words, "--weights", "lee", "--out", out)[1])
    cost = cost_matrix(*(load_clip(tmp_path / f"{n}.bvh").motion for n in ("one", "other")), "lee")
    room = cost[90:, : cost.shape[1] - 90]
    i, j = np.unravel_index(first_least(room), room.shape)  # a walk is as cheap a cycle later
    assert (told["from"], told["to"]) == (i + 90, j)
    assert told["total_frames"] == i + 91 + cost.shape[1] - j - 1
    assert call("blend", "one", "other:7", "--method", "cut", "--out", out)[0] == 2


@pytest.fixture
def clips(tmp_path):
    """A directory with two clips of 100 frames that are no loops, and one with a colon."""
    long = unroll(walker(0), 0, 300)[0]
    for name in ("one", "other", "with:colon"):
        motion = Motion(long.skeleton, long.rotations[:100], long.root[:100])
        write_bvh(motion, tmp_path / f"{name}.bvh")
    return tmp_path


@pytest.mark.parametrize("pair", [(0, 1), (1, 1)])
def test_a_cut_of_loops_has_room_and_tells_frames_of_the_loop(call, tmp_path, pair):
    names = [f"generated-walker-{n}" for n in pair]
    words = ("blend", *names, "--method", "cut", "--out", tmp_path / "c.bvh")
    for seconds in (6, 20):
        told = json.loads(call(*words, "--json", "--seconds", seconds)[1])
        frames = [len(walker(n)) for n in pair]
        assert 0 <= told["from"] < frames[0]
        assert 0 <= told["to"] < frames[1]
        assert told["mixed"][0] >= 15 * seconds
        assert told["total_frames"] - told["mixed"][0] - 1 >= 15 * seconds
    if pair[0] == pair[1]:
        apart = abs(told["from"] - told["to"])
        assert min(apart, walker(1).cycle.period - apart) > walker(1).cycle.period / 4
    out = call(*words)[1]
    assert "cut at" in out
    assert "0 frames of blend" not in out


def test_a_cut_of_short_clips_names_the_longest_that_fits(call, clips):
    words = ("blend", "one", "other", "--method", "cut", "--motions", clips, "--out")
    code, _, err = call(*words, clips / "c.bvh", "--seconds", 7)
    assert code == 2
    assert "at most 6.6 seconds (--seconds)" in err
    assert call(*words, clips / "c.bvh", "--seconds", 6.6)[0] == 0
    itself = ("blend", "one", "one", "--method", "cut", "--motions", clips, "--out")
    assert call(*itself, clips / "c.bvh", "--seconds", 5)[0] == 0


def test_a_colon_in_a_path_is_no_frame(call, clips):
    path = clips / "with:colon.bvh"
    words = ("blend", path, path, "--method", "cut", "--out", clips / "c.bvh")
    assert call(*words)[0] == 0


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--method", "cut", "--frames", 4), "no frames of blend"),
        (("--method", "cut", "--specification", "both"), "start-end or center-aligned"),
    ],
)
def test_a_cut_without_frames_is_refused_what_one_with_frames_is(call, clips, words, told):
    for ends in (("one", "other"), ("one:40", "other:40")):
        code, _, err = call("blend", *ends, *words, "--out", clips / "c.bvh", "--motions", clips)
        assert code == 2
        assert told in err


@pytest.mark.parametrize("option", [("--weights", "wang"), ("--seconds", "3")])
@pytest.mark.parametrize("method", ["cut", "geodesic"])
def test_options_of_a_cut_that_is_looked_for_are_refused_elsewhere(call, clips, option, method):
    code, _, err = call(
        "blend", "one:40", "other:40", "--method", method, *option,
        "--out", clips / "c.bvh", "--motions", clips,
    )  # fmt: skip
    assert code == 2
    assert option[0] in err
    assert len(err.splitlines()) == 2


def test_a_blend_tells_its_length_and_the_frames_mixed(call, clips):
    def said(*words):
        return call("blend", "one:40", "other:50", *words, "--out", clips / "c.bvh",
                    "--motions", clips)[1]  # fmt: skip

    centered = said("--frames", 10, "--specification", "center-aligned")
    assert "length 10, frames 35-45 mixed" in centered
    assert "length 1, frame 40 mixed" in said("--frames", 1)
    assert said("--method", "cut").endswith("cut at 40\n")


def test_a_length_at_the_clips_end_is_told_as_such(call, clips):
    words = ("length", "one:70", "other:8", "--motions", clips)
    lines = dict(line.split(maxsplit=1) for line in call(*words)[1].splitlines()[1:])
    assert "the clips allow 9 at most" in lines["fixed"]
    costs = json.loads(call(*words, "--json")[1])["geodesic"]["costs"]
    falls = costs[8] == min(cost for cost in costs if cost is not None)
    assert ("the curve still falls" in lines["geodesic"]) == falls
    assert "allow" not in call("length", "one:40", "other:40", "--motions", clips)[1]
    picture = clips / "l.svg"
    call(*words, "--out", picture)
    for words in ("no room: the clips allow 9", "a marker is a joint's minimum"):
        assert words in picture.read_text()


def test_the_choices_in_the_help_are_those_there_are(capsys):
    assert tuple(METHODS) == blend.METHOD_NAMES
    assert tuple(SPECIFICATIONS) == common.SPECIFICATION_NAMES
    for command in ("blend", "length"):
        with pytest.raises(SystemExit):
            main([command, "--help"])
        out = " ".join(capsys.readouterr().out.split())
        assert "begins at frame i of A and ends at frame j of B" in out
        assert "start-end or center-aligned" in out


@pytest.mark.parametrize("command", ["blend", "length", "cost", "weights", "fit"])
def test_help_has_no_blanks_and_loads_nothing_heavy(command):
    script = (
        "import sys\nfrom study.cli import main\n"
        f"try: main(['{command}', '--help'])\nexcept SystemExit: pass\n"
        "print([m for m in ('numpy', 'scipy', 'matplotlib') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})  # fmt: skip
    assert done.stdout.endswith("[]\n"), done.stderr
    parser = argparse.ArgumentParser()
    importlib.import_module(f"study.cli.{command}").add_arguments(parser)
    assert all(action.help for action in parser._actions)


def test_a_clip_name_longer_than_any_file_s_is_refused_and_not_printed_whole(call):
    code, _, err = call("cost", "a" * 5000, "generated-walker-0")
    assert code == 2
    assert len(err) < 1000
