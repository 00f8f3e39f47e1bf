"""A wheel built from the checkout and installed elsewhere does what the checkout does."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from study.screen.virtual import virtual_screen

ROOT = Path(__file__).resolve().parents[1]
SOURCES = ("analysis", "protocols", "stimuli", "study", "pyproject.toml", "README.md", "LICENSE")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of this checkout, built from a copy: building writes beside the sources."""
    copy, out = tmp_path_factory.mktemp("sources"), tmp_path_factory.mktemp("wheel")
    for name in SOURCES:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, copy / name)
    subprocess.run(
        [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation",
         "--no-index", "--wheel-dir", str(out), str(copy)],
        check=True, capture_output=True, text=True,
    )  # fmt: skip
    return next(out.glob("segue-*.whl"))


def test_the_wheel_holds_all_that_is_used_and_no_tests(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        held = set(archive.namelist())
    wanted = {
        str(path.relative_to(ROOT))
        for package in ("analysis", "protocols", "stimuli", "study")
        for path in (ROOT / package).rglob("*")
        if path.suffix in (".py", ".toml", ".html")
    }
    assert wanted <= held
    assert not [name for name in held if name.startswith("tests/")]


def test_installed_elsewhere_it_renders_and_runs_a_shipped_protocol(
    wheel: Path, tmp_path: Path, sample_motions: Path
) -> None:
    site, place = tmp_path / "site", tmp_path / "place"
    place.mkdir()
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    added = {"PYTHONPATH": str(site), "SEGUE_MOTIONS": str(sample_motions)}

    def segue(*words: str) -> str:
        done = subprocess.run(
            [sys.executable, "-m", "study.cli", *words], cwd=place, env=os.environ | added,
            capture_output=True, text=True, timeout=200, stdin=subprocess.DEVNULL,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        return done.stdout

    where = "import study; print(study.__file__)"
    origin = subprocess.run(
        [sys.executable, "-c", where],
        cwd=place,
        env=os.environ | added,
        capture_output=True,
        text=True,
    ).stdout
    assert origin.startswith(str(site))
    assert "12 clips, 12 of them to render" in segue("render", "study-four", "--dry-run")
    with virtual_screen(800, 600):
        segue(
            "run", "jnd-center", "--participant", "p1", "--rehearsal", "--observer", "simulated",
            "--windowed", "--pace", "10",
        )  # fmt: skip
    assert len(list((place / "stimulus-sets/jnd-center-rehearsal/clips").glob("*.mov"))) == 11
    assert (place / "data/sub-p1/beh/sub-p1_task-jndcenter_run-1_beh.tsv").is_file()
