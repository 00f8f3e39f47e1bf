"""Processes of ours are not led astray by somebody's files."""

import subprocess
from pathlib import Path

from stimuli.interpreter import ROOT, own_environment, own_python


def test_a_script_that_lies_about_is_taken_for_no_library(tmp_path: Path) -> None:
    for name in ("six", "queue", "study"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit(3)\n")
    done = subprocess.run(
        own_python("-c", "import queue, six, study; print(study.__file__)"),
        cwd=tmp_path, env=own_environment(), capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert Path(done.stdout.strip()).is_relative_to(ROOT)
