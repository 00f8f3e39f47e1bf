"""Folders made from a data set: whole or absent, beside it and never in it."""

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from stimuli.errors import InputError
from stimuli.files import permitted, refusals_name

_LEFT = (".lock", ".torn")  # of a session that runs, or of one that was killed


@contextmanager
def made_from(data: Path, out: Path, option: str) -> Iterator[Path]:
    """A new folder to fill, which becomes `out` when all went well.

    Raises InputError where `data` is no data set, where `out` is there, or lies in `data`.
    """
    if not any(data.glob("sub-*")):
        raise InputError(f"{data}: expected a data set with folders sub-*, found none")
    if out.exists():
        raise InputError(f"{option} {out}: expected a folder that is not there yet, found one")
    if data.resolve() in out.resolve().parents:
        raise InputError(f"{option} {out}: expected a place outside {data}, which is left as it is")
    with refusals_name(out):
        out.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=out.parent, prefix=".segue-") as near:
            folder = Path(near) / out.name
            folder.mkdir()
            folder.chmod(permitted() | 0o111)
            yield folder
            folder.replace(out)


def files_of(data: Path) -> Iterator[str]:
    """The files of a data set that are worth keeping, as paths in it with /, in order."""
    for path in sorted(data.rglob("*")):
        place = path.relative_to(data).as_posix()
        hidden = any(part.startswith(".") for part in place.split("/"))
        if path.is_file() and not hidden and path.suffix not in _LEFT:
            yield place
