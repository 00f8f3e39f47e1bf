"""Which clips of a library make a collection, by the patterns of their names."""

from collections.abc import Callable, Sequence
from fnmatch import fnmatchcase
from pathlib import Path

from stimuli.collection.gather import Collection, gathered
from stimuli.errors import InputError
from stimuli.motion.clip import Clip
from stimuli.motion.library import Library


def collected(
    library: Library,
    patterns: Sequence[str] = ("*",),
    tell: Callable[[str], None] = lambda note: None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Collection:
    """All clips of a library whose stems match a pattern, as one collection.

    Files that are refused are told of and left out. InputError where a pattern matches none, and
    where clips do not go together.
    """
    paths = [path for path in library.paths() if _matches(path, patterns)]
    for pattern in patterns:
        if not any(_matches(path, (pattern,)) for path in paths):
            places = ", ".join(map(str, library.directories)) or "no directory"
            raise InputError(
                f"{pattern}: expected clips of such names in {places}, found none.\n"
                "`segue motions` lists clips; --motions names a directory, `segue motions fetch` "
                "brings samples."
            )
    clips: list[Clip] = []
    for done, path in enumerate(paths, start=1):
        try:
            clips.append(library.load(path))
        except InputError as error:
            tell(f"left out: {error}")
        progress(done, len(paths))
    return gathered(clips)


def _matches(path: Path, patterns: Sequence[str]) -> bool:
    return any(fnmatchcase(path.stem, pattern) for pattern in patterns)
