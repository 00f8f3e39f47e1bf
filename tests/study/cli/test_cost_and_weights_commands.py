"""The commands cost and weights, and the outputs of length and blend: figures, refusals, tables."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from analysis.errors import InputError as AnalysisError
from analysis.files import write_atomic as write_report
from stimuli.errors import InputError
from stimuli.files import check_writable, write_atomic
from stimuli.motion import load_clip, write_walker
from stimuli.motion.formats.bvh_write import write_bvh
from stimuli.transition import plots
from stimuli.transition.points import TransitionPoint, default_sigma, probabilities
from study.cli import main
from study.cli.common import print_json

A, B = "generated-walker-0", "generated-walker-1"
HEADER = "from_clip,from_frame,to_clip,to_frame,good"


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """A directory with two generated walkers."""
    folder = tmp_path_factory.mktemp("lib")
    for seed in (0, 1):
        write_walker(folder, seed)
    return folder


@pytest.fixture
def call(capsys, library, tmp_path, monkeypatch):
    """Calls the command line on the walkers, in an empty directory; exit code, output, errors."""
    monkeypatch.chdir(tmp_path)

    def run(*words):
        try:
            code = main([*map(str, words), "--motions", str(library)])
        except SystemExit as bad_usage:
            code = bad_usage.code
        said = capsys.readouterr()
        return code, said.out, said.err

    return run


@pytest.fixture
def labels(tmp_path):
    """Writes rows below the header of a table of labels; returns its path."""

    def write(*rows: str) -> Path:
        path = tmp_path / "labels.csv"
        path.write_text("\n".join([HEADER, *rows]) + "\n")
        return path

    return write


def apart(good: int, bad: int) -> list[str]:
    """Rows that are good where both walkers are at one place of their step, bad half a step on."""
    return [f"{A},{n + 4},{B},{n + 4},1" for n in range(good)] + [
        f"{A},{n + 4},{B},{(n + 16) % 28},0" for n in range(bad)
    ]


@pytest.mark.parametrize(
    ("option", "values"),
    [
        ("--velocity-weight", ("nan", "inf", "-1", "1e7", "x")),
        ("--sigma", ("0", "nan", "inf", "-1")),
        ("--before", ("-1", "1.5")),
        ("--after", ("-1",)),
        ("--count", ("0", "-3")),
    ],
)
def test_numbers_that_mean_nothing_are_refused_before_any_work(call, option, values):
    for value in values:
        code, out, err = call("cost", "nobody", "nobody", option, value, "--json")
        assert (code, out) == (2, "")
        assert option in err
        assert value in err
        assert len(err.splitlines()) == 1
    for command in ("cost", "weights"):
        code, _, err = call(command, "nobody", "--velocity-weight", "nan")
        assert code == 2
        assert "--velocity-weight" in err


@pytest.mark.parametrize("json_too", [(), ("--json",)])
def test_room_that_no_frame_has_is_refused_with_the_room_there_is(call, library, json_too):
    frames = json.loads(call("cost", A, B, "--json")[1])["frames"]
    for clips, (before, after) in (((A, B), frames), ((library, library), [max(frames)] * 2)):
        code, out, err = call("cost", *clips, "--before", 100_000, *json_too)
        assert (code, out) == (2, "")
        assert "--before 100000" in err
        assert f"{before - 1} frames before it and {after - 1} after" in err
        assert call("cost", *clips, "--after", max(frames), *json_too)[0] == 2


def test_room_without_a_minimum_is_an_answer(call):
    whole = json.loads(call("cost", A, B, "--json")[1])
    last = whole["frames"][0] - 1
    first = min(point["to"] for point in whole["local_minima"] if point["from"] == last)
    words = ("cost", A, B, "--before", last, "--after", whole["frames"][1] - first)
    code, out, _ = call(*words, "--json")
    found = json.loads(out)
    assert (code, found["minimum"], found["local_minima"]) == (0, None, [])
    assert f"{last} frames before" in call(*words)[1]


@pytest.mark.parametrize("sigma", [None, 0.05])
def test_cost_tells_sigma_and_the_probability_of_every_minimum(call, sigma):
    given = [] if sigma is None else ["--sigma", sigma]
    code, out, _ = call("cost", A, B, "--json", "--npz", "c.npz", *given)
    found, saved = json.loads(out), np.load("c.npz")
    assert code == 0
    assert found["sigma"] == saved["sigma"]
    assert np.isclose(found["sigma"], sigma or default_sigma(saved["cost"]))
    assert np.allclose(saved["probability"], probabilities(saved["cost"], found["sigma"]))
    for point in found["local_minima"]:
        assert point["probability"] == saved["probability"][point["from"], point["to"]]
    assert found["minimum"] == found["local_minima"][0]
    text = call("cost", A, B, *given)[1]
    assert f"σ = {found['sigma']:.6g}" in text
    assert f"{found['minimum']['probability']:.4g}" in text


def test_a_search_of_directories_has_its_minimum(call, library):
    found = json.loads(call("cost", library, library, "--count", 3, "--json")[1])
    assert found["minimum"] == found["local_minima"][0]
    assert call("cost", library, library, "--sigma", 1)[0] == 2


def test_a_document_that_is_no_json_leaves_nothing_on_stdout(capsys):
    with pytest.raises(ValueError, match="JSON"):
        print_json({"first": 1, "second": float("nan")})
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("cost", A, B, "--out", "c.xyz"), "c.xyz"),
        (("cost", A, B, "--out", "zz.png", "--npz", "o.txt/z.npz"), "o.txt/z.npz"),
        (("cost", A, B, "--npz", "o.txt"), "o.txt"),
        (("cost", A, B, "--npz", "folder.npz"), "folder.npz"),
        (("cost", A, B, "--npz", "n" * 300 + ".npz"), ".npz"),
        (("cost", "nobody", B, "--out", "/proc/c.png"), "/proc/c.png"),
        (("length", f"{A}:5", f"{B}:20", "--out", "o.txt/l.png"), "o.txt/l.png"),
        (("length", f"{A}:5", f"{B}:20", "--out", "l.bmp2"), "l.bmp2"),
        (("blend", f"{A}:5", f"{B}:20", "--out", "o.txt/j.bvh"), "o.txt/j.bvh"),
        (("weights", "no.csv", "--out", "o.txt/w.toml"), "o.txt/w.toml"),
        (("weights", "no.csv", "--out", "w.csv"), "w.csv"),
    ],
)
def test_outputs_that_cannot_be_written_are_refused_before_any_work(call, tmp_path, words, named):
    (tmp_path / "o.txt").write_text("kept")
    (tmp_path / "folder.npz").mkdir()
    code, out, err = call(*words)
    assert (code, out) == (2, "")
    assert named in err
    assert len(err.splitlines()) <= 2
    assert ".part" not in err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder.npz", "o.txt"]


def test_a_file_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "o.txt").write_text("kept")
    for path in (tmp_path / "o.txt" / "z" / "deep", tmp_path / ("n" * 300), tmp_path):
        for write, kind in ((write_atomic, InputError), (write_report, AnalysisError)):
            with pytest.raises(kind) as refusal:
                write(path, "text")
            said = str(refusal.value)
            assert said.startswith(f"{path}: expected")
            assert ".part" not in said
            assert "Errno" not in said
        with pytest.raises(InputError):
            check_writable(path)
    assert [path.name for path in tmp_path.iterdir()] == ["o.txt"]


def test_a_name_of_any_length_the_system_takes_can_be_written(tmp_path):
    path = tmp_path / "new" / ("n" * 251 + ".npz")
    check_writable(path)
    assert list(tmp_path.iterdir()) == []
    write_atomic(path, "text")
    assert path.read_text() == "text"


def test_bad_weights_are_told_before_clips_are_looked_for(call, tmp_path):
    (tmp_path / "w.json").write_text("[1, 2]")
    code, _, err = call("cost", "nobody", "nobody", "--weights", "w.json")
    assert code == 2
    assert "w.json" in err


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        ((), ["header alone"]),
        (("", "", f"{A},x,{B},2,1"), ["line 4", "from_frame", "'x'"]),
        ((f"{A},1,{B},2,1", "", f"{A},1,{B},999,0"), ["line 4", "to_frame", "999"]),
        ((f"{A},1,{B}",), ["line 2", "good"]),
        ((f"{A},1,{B},2,maybe",), ["line 2", "good", "maybe"]),
        ((f"{A},1,{B},-2,1",), ["line 2", "to_frame", "-2"]),
        ((f"{A},1,{B},2,1", f"{'n' * 200_000},1,{B},2,1"), ["field"]),
        (tuple(f"{A},1,{B},{n},maybe" for n in range(5)), ["line 2", "line 4", "2 more"]),
    ],
)
def test_faults_of_labels_are_told_with_their_lines(call, labels, rows, told):
    code, out, err = call("weights", labels(*rows))
    assert (code, out) == (2, "")
    assert "labels.csv" in err
    assert len(err.splitlines()) == 1
    for word in told:
        assert word in err


def test_all_columns_that_are_missing_are_named(call, tmp_path):
    for text, absent in (("from_clip,to_clip,good\n", "from_frame, to_frame"), ("", "from_clip")):
        (tmp_path / "l.csv").write_text(text + "a,b,1\n" if text else text)
        code, _, err = call("weights", "l.csv")
        assert code == 2
        assert f"found no {absent}" in err


def test_clips_of_different_hierarchies_are_told_with_their_line(call, labels, library, tmp_path):
    stranger = tmp_path / "stranger.bvh"
    write_bvh(load_clip(library / f"{A}.json").motion, stranger)
    stranger.write_text(stranger.read_text().replace("JOINT left_knee", "JOINT Left_Knee"))
    code, _, err = call("weights", labels(*apart(2, 2), f"{A},1,{stranger},2,0"))
    assert code == 2
    assert "line 6" in err
    assert "hierarchy" in err
    code, _, err = call("weights", labels(*apart(2, 2)), "--other", A, stranger)
    assert code == 2
    assert "hierarchy" in err


def test_weights_print_the_roles_and_the_whole_table(call, labels):
    code, out, _ = call("weights", labels(*apart(1, 5)), "--other", B, A)
    assert code == 0
    for role in ("left_hip", "right_hip", "left_knee", "pelvis"):
        assert role in out
    table = [line.split() for line in out.splitlines() if f"{A}:" in line]
    assert [row[:3] for row in table] == [[f"{A}:4", f"{B}:4", "good"]] + [
        [f"{A}:{n + 4}", f"{B}:{(n + 16) % 28}", "bad"] for n in range(5)
    ]
    assert "cannot be left out: the only one of its kind" in " ".join(table[0])
    assert all(len(row) == 5 and row[3].isdigit() and row[4].isdigit() for row in table[1:])


def test_weights_with_one_label_of_a_kind_are_found_all_the_same(call, labels):
    for good, bad in ((1, 5), (1, 1)):
        code, out, _ = call("weights", labels(*apart(good, bad)), "--json")
        found = json.loads(out)
        assert code == 0
        assert found["leave_one_out"][0]["moved"] is None
        assert found["leave_one_out"][0]["reason"] == "the only one of its kind"
        assert found["leave_one_out"][0]["label"] == {
            "from": f"{A}:4", "to": f"{B}:4", "good": True,
        }  # fmt: skip
        assert found["summary"]["count"] == (bad if bad > 1 else 0)
    assert "no label can be left out" in call("weights", labels(*apart(1, 1)))[1]


def test_weights_judge_by_points_with_room(call, labels):
    path = labels(*apart(4, 4))
    found = json.loads(call("weights", path, "--before", 8, "--after", 6, "--json")[1])
    frames = json.loads(call("cost", A, B, "--json")[1])["frames"]
    for entry in found["leave_one_out"]:
        for row, column in (("from", "to"), ("from_without", "to_without")):
            assert entry[row] >= 8
            assert entry[column] < frames[1] - 6
    code, _, err = call("weights", path, "--before", 1000)
    assert code == 2
    assert "--before 1000" in err
    assert call("weights", path, "--before", -1)[0] == 2


@pytest.mark.parametrize("name", ["w.toml", "w.json"])
def test_weights_that_are_written_can_be_read(call, labels, name):
    assert call("weights", labels(*apart(4, 4)), "--out", name)[0] == 0
    assert call("cost", A, B, "--weights", name)[0] == 0


def test_a_search_shows_its_progress_on_a_terminal_even_one_without_a_size(library):
    leader, follower = os.openpty()
    done = subprocess.run(
        [sys.executable, "-m", "study.cli", "cost", str(library), str(library), "--count", "2"],
        stdout=subprocess.PIPE, stderr=follower, check=True, text=True, timeout=120,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )  # fmt: skip
    os.close(follower)
    shown = os.read(leader, 10_000).decode()
    os.close(leader)
    assert "searching:" in shown
    assert len(done.stdout.splitlines()) == 4  # two of them a header


def test_a_search_of_a_directory_in_itself_prints_every_pair_once_in_columns(call, library):
    first, header, *lines = call("cost", library, library, "--count", 5)[1].splitlines()
    assert first.startswith("the 5 cheapest of 2 clips to 2")
    pairs = [frozenset((line.split()[0], line.split()[2])) for line in lines]
    assert len(set(pairs)) == len(lines) == 5
    assert any("↔" in line for line in lines)
    assert len({len(line) for line in (header, *lines)}) == 1


def test_options_that_a_directory_cannot_have_are_named_alone(call, library):
    err = call("cost", library, library, "--sigma", 1)[2]
    assert "--sigma" in err
    assert "--npz" not in err


def test_a_frame_is_not_wanted_of_the_cost(call):
    code, _, err = call("cost", f"{A}:3", B)
    assert code == 2
    assert "without a frame" in err
    assert err.endswith(f"Give {A}.\n")


def test_files_that_are_written_are_told(call):
    out = call("cost", A, B, "--out", "c.svg", "--npz", "c.npz")[1]
    assert out.splitlines()[-2:] == ["written: c.svg", "written: c.npz"]
    words = ("length", f"{A}:5", f"{B}:20", "--out", "l.svg")
    assert call(*words)[1].endswith("drawn: l.svg\n")
    json.loads(call(*words, "--json")[1])
    picture = Path("c.svg").read_text()
    for word in ("frame (30 a second)", "the 10 cheapest", "the best", "local minimum"):
        assert f"<!-- {word} -->" in picture or word in picture


def test_a_best_point_on_the_edge_is_drawn_whole_and_the_edges_stay(monkeypatch, tmp_path):
    drawn = []
    monkeypatch.setattr(plots, "save", lambda figure, path: drawn.append(figure))
    cost = np.arange(12.0).reshape(3, 4)
    plots.draw_cost(cost, [TransitionPoint(0, 0, 0.0)], ("a", "b"), tmp_path / "c.png")
    axes = drawn[0].axes[0]
    assert not any(line.get_clip_on() for line in axes.lines)
    assert (axes.get_xlim(), axes.get_ylim()) == ((-0.5, 3.5), (2.5, -0.5))
    (legend,) = drawn[0].legends
    said = [text.get_text() for text in legend.get_texts()]
    assert said == ["local minimum", "the only one", "the best"]


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_tables_are_read_with_any_separator(call, labels, separator, mark):
    path = labels(*apart(3, 4))
    found = call("weights", path, "--json")[1]
    path.write_text(mark + path.read_text().replace(",", separator), encoding="utf-8")
    assert call("weights", path, "--json")[:2] == (0, found)


@pytest.mark.parametrize("command", ["weights", "fit"])
@pytest.mark.parametrize(
    ("content", "told"),
    [
        (None, "found no such file"),
        ("a,b\n".encode("utf-16"), "found UTF-16"),
        ("a,b\n".encode("utf-16-le"), "found UTF-16"),
        ("stück,b\n".encode("latin-1"), "found another encoding"),
    ],
)
def test_tables_that_cannot_be_read_are_refused_in_words(
    call, capsys, tmp_path, command, content, told
):
    path = tmp_path / "t.csv"
    if content is not None:
        path.write_bytes(content)
    words = [command, str(path)]
    code, err = main(words), capsys.readouterr().err
    assert code == 2
    assert told in err
    for python in ("Errno", "codec", "byte"):
        assert python not in err


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("level;correct;total\n0,5;3;10\n", "a decimal comma: write 0.5"),
        ("level,correct,total\n0,5,3,10\n", "more fields than columns"),
        ("level;correct;total\n\n1;x;10\n", "t.csv:3: expected numbers"),
    ],
)
def test_faults_of_a_table_to_fit_are_told(capsys, tmp_path, text, told):
    path = tmp_path / "t.csv"
    path.write_text(text)
    assert main(["fit", str(path)]) == 2
    assert told in capsys.readouterr().err


def test_weights_files_that_cannot_be_read_are_refused_in_words(call, tmp_path):
    (tmp_path / "wide.toml").write_bytes("hip = 1\n".encode("utf-16"))
    (tmp_path / "bad.json").write_text("{")
    for name, told in (
        ("none.toml", "found no such file"),
        ("wide.toml", "another encoding"),
        ("bad.json", "no JSON"),
    ):
        code, _, err = call("cost", A, B, "--weights", name)
        assert code == 2
        assert told in err
        assert "Errno" not in err
        assert len(err.splitlines()) == 2


def test_few_labels_get_a_note(call, labels):
    code, out, err = call("weights", labels(*apart(2, 2)), "--out", "w.toml")
    assert code == 0
    assert "4 labels for" in err
    assert out.endswith("weights written: w.toml\n")
    assert "note" not in call("weights", labels(*apart(8, 8)))[2]
