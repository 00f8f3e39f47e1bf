"""Files that are whole or absent: written beside their place, synced, then renamed."""

import errno
import hashlib
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from stimuli.errors import UnwritableError

NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)  # there is no room for what is written


def write_atomic(path: Path, content: str | bytes) -> None:
    """Write `content` (text as UTF-8) to `path`, which never holds a half-written file.

    Missing directories are made. UnwritableError that names `path` where it cannot be written.
    """
    data = content.encode() if isinstance(content, str) else content
    with refusals_name(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        start = f".{path.name[:40]}."  # a name may be as long as the system lets it
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=start, suffix=".part")
        beside = Path(name)
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(data)
                stream.flush()
                os.fsync(stream.fileno())
            beside.chmod(permitted())
            beside.replace(path)
        except BaseException:
            beside.unlink(missing_ok=True)
            raise


def check_writable(path: Path) -> None:
    """UnwritableError unless a file can be written to `path`; leaves nothing behind.

    Tried in the nearest directory that is there, since permissions do not tell of a read-only
    disk, nor of what the superuser may not do either.
    """
    with refusals_name(path):
        if path.is_dir():
            raise IsADirectoryError(None, "a directory")
        there = next(above for above in path.absolute().parents if above.exists())
        with tempfile.TemporaryFile(dir=there):
            pass


def sha256(path: Path) -> str:
    """SHA-256 of a file's bytes, in hexadecimal."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


@contextmanager
def refusals_name(path: Path) -> Iterator[None]:
    """What the system refuses, said of the file that was wanted, not of one beside it.

    UnwritableError within the block for every OSError.
    """
    try:
        yield
    except OSError as error:
        remedy = "make room on it" if error.errno in NO_ROOM else "make that one writable"
        raise UnwritableError(
            f"{path}: expected a place where a file can be written, found: "
            f"{error.strerror or error}.\nChoose another, or {remedy}."
        ) from error


def permitted() -> int:
    """The mode that a new file of this user has; a temporary one has a narrower."""
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
