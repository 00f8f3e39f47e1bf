"""Writing files so that a reader sees the old one or the new one, never a part."""

import os
import tempfile
from pathlib import Path

from analysis.errors import InputError


def write_atomic(path: Path, content: str | bytes) -> None:
    """Write beside `path`, then rename; missing directories are made.

    InputError that names `path` where it cannot be written.
    """
    try:
        _write(path, content.encode() if isinstance(content, str) else content)
    except OSError as error:
        raise InputError(
            f"{path}: expected a place where a file can be written, found: "
            f"{error.strerror or error}.\nChoose another, or make that one writable."
        ) from error


def _write(path: Path, data: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        Path(name).chmod(0o644)
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
