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
            f"{error.strerror or error}.\nChoose another, or see that there is room to write."
        ) from error


def _write(path: Path, data: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    start = f".{path.name[:40]}."  # a name may be as long as the system lets it
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=start, suffix=".part")
    beside = Path(name)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        beside.chmod(0o666 & ~_umask())
        beside.replace(path)
    except BaseException:
        beside.unlink(missing_ok=True)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
