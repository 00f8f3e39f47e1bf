"""A place for what PsychoPy writes about itself when it is loaded, for users without one."""

import atexit
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

FOLDER = "APPDATA" if os.name == "nt" else "HOME"


def has_home() -> bool:
    """Whether this user has a home folder that can be written."""
    folder = os.environ.get(FOLDER)
    return bool(folder) and _writable(Path(str(folder)))


@contextmanager
def writable_home() -> Iterator[None]:
    """Within this block the home folder is one that can be written.

    PsychoPy cannot be loaded without one, for its settings; nothing of a session lies there. A
    user who has none gets one that lasts as long as the process.
    """
    before = os.environ.get(FOLDER)
    if has_home():
        yield
        return
    made = tempfile.TemporaryDirectory(prefix="segue-home-")
    atexit.register(made.cleanup)
    os.environ[FOLDER] = made.name
    try:
        yield
    finally:
        if before is None:
            del os.environ[FOLDER]
        else:
            os.environ[FOLDER] = before


def _writable(folder: Path) -> bool:
    try:
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False
