"""`segue render`, as a person calls it."""

import json
import re
import shutil
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from stimuli.motion import Library
from stimuli.sets import load_manifest
from stimuli.sets.video import decode_video, read_clip
from study.cli import main
from study.protocol.protocol import shipped


@pytest.fixture
def protocol(tmp_path: Path) -> Path:
    """The shipped jnd-center with two lengths, half a second long, in very small pictures."""
    text = shipped()["jnd-center"].read_text(encoding="utf-8")
    text = text.replace("lengths = [2, 4, 6, 8, 12, 14, 16, 18, 20, 22]", "lengths = [8, 12]")
    text = text.replace("reference = 10", "reference = 10\nseconds = 0.5", 1)
    small = 'width = 96\nheight = 72\nstyle = "mannequin"\ncamera = "fixed"\n'
    text = re.sub(r"\[appearance\]\n(?:[^\[\n].*\n)*", f"[appearance]\n{small}", text)
    path = tmp_path / "tiny.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_render_builds_a_set_once(
    protocol: Path, library: Library, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "set"
    command = [
        "render", str(protocol), "--set", "generated", "--out", str(out), "--workers", "1",
        "--motions", str(library.directories[0]),
    ]  # fmt: skip
    assert main([*command, "--dry-run", "--json"]) == 0
    planned = json.loads(capsys.readouterr().out)
    assert planned["clips"] == planned["missing"] == 6
    assert planned["pairings"]["locomotion"]["lengths"] == [8, 10, 12]
    assert not out.exists()
    assert main([*command, "--strips", "--json"]) == 0
    told = capsys.readouterr()
    built = json.loads(told.out)
    assert built["clips"] == built["rendered"] == 6
    assert sorted(path.name for path in (out / "strips").iterdir()) == [
        f"{name}-{length:02d}.png" for name in ("dance", "locomotion") for length in (8, 10, 12)
    ]
    assert main(command) == 0
    assert "6 clips, 0 rendered now" in capsys.readouterr().out
    shutil.rmtree(out / "strips")


def test_what_people_look_at_lies_beside_the_masters(
    protocol: Path, library: Library, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "set"
    command = [
        "render", str(protocol), "--set", "generated", "--out", str(out), "--workers", "1",
        "--motions", str(library.directories[0]),
    ]  # fmt: skip
    looks = ["--web", "--glb", "--sheet"]
    assert main([*command, *looks, "--json"]) == 0
    told = capsys.readouterr()
    assert json.loads(told.out)["rendered"] == 6
    assert f"sheet: {out / 'sheet.html'} and {out / 'sheet.png'}" in told.err
    kinds = Counter(path.suffix for path in (out / "clips").iterdir())
    assert kinds == {".mov": 6, ".json": 6, ".mp4": 6, ".glb": 6}
    for entry in load_manifest(out).clips:
        master, web = read_clip(entry), decode_video(entry.path.with_suffix(".mp4"))
        assert np.abs(master.astype(int) - web)[:, :8, :8].max() <= 1  # grey
        apart = [np.abs(frame.astype(int) - master).mean(axis=(1, 2, 3)).argmin() for frame in web]
        assert apart[5:10] == list(range(5, 10))
    times = {path: path.stat().st_mtime_ns for path in (out / "clips").iterdir()}
    assert main([*command, *looks]) == 0
    assert {path: path.stat().st_mtime_ns for path in (out / "clips").iterdir()} == times
    protocol.write_text(protocol.read_text().replace("width = 96", "width = 100"))
    assert main([*command, "--prune"]) == 0
    kinds = Counter(path.suffix for path in (out / "clips").iterdir())
    assert kinds == {".mov": 6, ".json": 6}


@pytest.mark.parametrize(
    ("options", "what"),
    [
        (["--workers", "0"], "--workers"),
        (["--workers", "2", "--scheduler", "tcp://127.0.0.1:1"], "expected one of them"),
        (["--device", "best", "--set", "generated"], "--device"),
        (["--set", "nowhere"], "nowhere"),
        (["--set", "cmu"], "07_03"),
    ],
)
def test_bad_input_is_refused(
    protocol: Path,
    library: Library,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    options: list[str],
    what: str,
) -> None:
    command = ["render", str(protocol), "--out", str(tmp_path / "set")]
    assert main([*command, "--motions", str(library.directories[0]), *options]) == 2
    told = capsys.readouterr().err.strip()
    assert what in told
    assert len(told.splitlines()) <= 2
    assert not (tmp_path / "set").exists()


def test_a_missing_protocol_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["render", "no-such-protocol"]) == 2
    assert "no-such-protocol" in capsys.readouterr().err
