"""Files of the report: whole or not at all, under any name that a file can have."""

import os
from pathlib import Path

import pytest

from analysis.errors import InputError
from analysis.files import write_atomic


def test_the_longest_name_is_written_with_the_usual_permissions(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        path = tmp_path / ("n" * 255)
        write_atomic(path, "all of it")
    finally:
        os.umask(before)
    assert path.read_text() == "all of it"
    assert path.stat().st_mode & 0o777 == 0o640
    assert list(tmp_path.iterdir()) == [path]


def test_a_file_in_the_way_of_a_folder_is_named(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("kept")
    with pytest.raises(InputError, match="taken"):
        write_atomic(tmp_path / "taken" / "report.json", "{}")
    assert (tmp_path / "taken").read_text() == "kept"
