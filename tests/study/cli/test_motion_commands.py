"""The commands motions, cost, length, blend and weights, as a person calls them."""

import csv
import json

import numpy as np
import pytest

from stimuli.motion import Motion, load, unroll, walker, write_walker
from stimuli.motion.formats.bvh_write import write_bvh
from stimuli.transition import cost_matrix
from study.cli import main


@pytest.fixture
def library(tmp_path):
    """A directory with three generated walkers."""
    for seed in (0, 1, 2):
        write_walker(tmp_path / "lib", seed)
    return tmp_path / "lib"


@pytest.fixture
def call(capsys, library):
    """Calls the command line on the walkers; returns exit code, output and errors."""

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
    clip = load(out)
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
    cost = cost_matrix(*(load(tmp_path / f"{n}.bvh").motion for n in ("one", "other")), "lee")
    room = cost[90:, : cost.shape[1] - 90]
    i, j = np.unravel_index(np.argmin(room), room.shape)
    assert (told["from"], told["to"]) == (i + 90, j)
    assert told["total_frames"] == i + 91 + cost.shape[1] - j - 1
    assert call("blend", "one", "other:7", "--method", "cut", "--out", out)[0] == 2
