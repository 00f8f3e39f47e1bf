"""The command line as a user meets it: exit codes, two-line errors, JSON alone on stdout."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def segue(*words: str, cwd: Path = ROOT, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "study.cli", *words],
        cwd=cwd, capture_output=True, text=True, timeout=120,
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment}, stdin=subprocess.DEVNULL,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("simulate", "jnd-centre", "--participants", "2"), "jnd-center"),
        (("simulate", "jnd-center", "--participants", "0"), "--participants"),
        (("simulate", "jnd-center", "--participants", "2", "--set", "mine"), "sample"),
        (("certify", "study-one", "--sets", "2", "--set", "mine"), "sample"),
        (("run", "jnd-center", "--participant", "../../x"), "letters and digits"),
        (("run", "jnd-center", "--participant", "p1", "--pace", "0"), "--pace"),
        (("length", "nope:1", "nada:2"), "nope"),
        (("report", "nothing-here"), "nothing-here"),
        (("render", "jnd-center", "--motions", "nowhere"), "segue motions fetch"),
        (("cost", "a"), "B"),
        (("cost", "a", "b", "--velocity-weight", "nan", "--json"), "--velocity-weight"),
        (("cost", "a", "b", "--out", "c.xyz"), "c.xyz"),
        (("length", "a:1", "b:2", "--out", "/proc/l.png"), "/proc/l.png"),
        (("blend", "a:1", "b:2", "--out", "/proc/j.bvh"), "/proc/j.bvh"),
        (("weights", "l.csv", "--out", "/proc/w.toml"), "/proc/w.toml"),
    ],
)
def test_bad_input_is_said_in_a_line_or_two(tmp_path: Path, words, said: str) -> None:
    done = segue(*words, cwd=tmp_path, XDG_DATA_HOME=str(tmp_path / "home"), SEGUE_MOTIONS="")
    assert done.returncode == 2, done.stderr
    assert said in done.stderr
    assert len(done.stderr.splitlines()) <= 2
    assert "Traceback" not in done.stderr
    assert done.stdout == ""
    assert list(tmp_path.iterdir()) == []


def test_a_protocol_with_three_faults_names_all_three(tmp_path: Path) -> None:
    path = tmp_path / "p.toml"
    path.write_text(
        'name = "x y"\ntask = "odd"\n[stimuli]\nseconds = -1\n'
        'motions = [{ name = "m", from = "a", to = "a" }]\n[sets.s]\n'
        'a = { clip = "c", frame = 0 }\n'
    )
    done = segue("simulate", str(path), "--participants", "1", "--data", str(tmp_path / "d"))
    assert done.returncode == 2
    lines = done.stderr.splitlines()
    for key, number in (("name", 1), ("task", 2), ("stimuli.seconds", 4)):
        assert any(f"p.toml:{number}: {key}:" in line for line in lines), done.stderr
    assert not (tmp_path / "d").exists()


def test_a_traceback_only_with_debug() -> None:
    done = segue("simulate", "nothing", "--participants", "1", "--debug")
    assert "Traceback" in done.stderr


def test_unknown_commands_are_bad_usage() -> None:
    assert segue("dance").returncode == 2
    assert segue().returncode == 2


def test_json_is_one_document_and_nothing_else(tmp_path: Path) -> None:
    data = str(tmp_path / "d")
    done = segue("simulate", "jnd-center", "--participants", "2", "--data", data, "--json")
    document = json.loads(done.stdout)
    assert [record["trials"] > 30 for record in document["records"]] == [True, True]
    assert done.stderr == ""


def test_a_stranger_named_stimuli_is_found_out(tmp_path: Path) -> None:
    (tmp_path / "stimuli").mkdir()
    (tmp_path / "stimuli" / "__init__.py").write_text("")
    script = (
        f"import sys; sys.path.insert(1, {str(ROOT)!r})\n"
        "from study.cli import main\n"
        "sys.exit(main(['doctor']))"
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        cwd=tmp_path, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 2
    assert str(tmp_path) in done.stderr
