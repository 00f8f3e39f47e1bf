"""Where clips lie: directories given, those of SEGUE_MOTIONS, else the user's own library."""

import os
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from pathlib import Path

from stimuli.errors import InputError
from stimuli.motion.clip import Clip, load_clip
from stimuli.motion.formats import READERS
from stimuli.motion.formats.amass import is_amass
from stimuli.motion.overrides import OVERRIDES

_SNIFFED = {".txt", ".json"}  # suffixes that other files carry too
_LONGEST_SHOWN = 400  # letters of a name in a message
_NEVER_FOUND = {".asf", ".c3d"}  # formats that are always refused are no clips to be named


class Library:
    """Clips under some directories, found by path or by stem; each is read once.

    A directory's clips are those below it too. Reading keeps the clips in memory.
    """

    def __init__(self, directories: Iterable[Path | str]) -> None:
        self.directories = tuple(Path(directory) for directory in directories)
        self._clips: dict[Path, Clip] = {}

    @cached_property
    def _paths(self) -> tuple[Path, ...]:
        for directory in self.directories:
            if not directory.exists():
                raise InputError(
                    f"{directory}: expected a directory of motion clips, found nothing there.\n"
                    "Give another with --motions, or fetch samples with `segue motions fetch`."
                )
        found = (path for directory in self.directories for path in clips_under(directory))
        return tuple(dict.fromkeys(found))

    def paths(self) -> tuple[Path, ...]:
        """All clips, sorted within each directory."""
        return self._paths

    def candidates(self, name: str | Path) -> list[Path]:
        """All clips that a name can mean: the file of that path, else clips called so."""
        path = Path(name)
        with suppress(OSError):  # a name longer than any file's
            if path.is_file():
                return [path]
        return [p for p in self._paths if _is_called(p, path) and p.suffix not in _NEVER_FOUND]

    def find(self, name: str | Path) -> Path:
        """The clip of that path, or the only one of that name; else InputError.

        A name is a stem, with or without suffix, and with as many folders before it as tell it
        from others: `05_13`, `05_13.amc`, `cmu_bvh/05_13`.
        """
        found = self.candidates(name)
        if len(found) == 1:
            return found[0]
        places = ", ".join(str(directory) for directory in self.directories) or "no directory"
        name = _shown(name)
        if found:
            listed = ", ".join(str(p) for p in found[:6])
            raise InputError(
                f"{name}: expected one clip of that name, found {len(found)}: {listed}.\n"
                "Give the path of the one that is meant."
            )
        raise InputError(
            f"{name}: expected a clip of that path or name, found none in {places}.\n"
            "`segue motions` lists clips; --motions names a directory, "
            "`segue motions fetch` brings samples."
        )

    def load(self, name: str | Path) -> Clip:
        """The clip of that path or stem, read once under whatever name.

        Copies of a file share one motion unless overrides tell them apart.
        """
        path = self.find(name)
        key = path.resolve()
        if key not in self._clips:
            self._clips[key] = self._sharing(load_clip(path))
        return self._clips[key]

    def _sharing(self, clip: Clip) -> Clip:
        """The clip, with the motion of a copy of its file where that is no other."""
        for other in self._clips.values():
            if other.sha256 == clip.sha256 and other.motion.same_as(clip.motion):
                return replace(clip, motion=other.motion)
        return clip


def _shown(name: str | Path) -> str:
    """A name as messages show it, cut where no file's could go on."""
    text = str(name)
    return text if len(text) <= _LONGEST_SHOWN else f"{text[:_LONGEST_SHOWN]}…"


def _is_called(path: Path, name: Path) -> bool:
    """Whether the end of a path is that name, with the suffix or without."""
    count = len(name.parts)
    return name.parts in (path.parts[-count:], path.with_suffix("").parts[-count:])


def clips_under(directory: Path) -> list[Path]:
    """Motion clips in a directory and below it, or the file itself; sorted."""
    if directory.is_file():
        return [directory]
    return sorted(path for path in directory.rglob("*") if is_clip(path))


def is_clip(path: Path) -> bool:
    """Whether a file looks like a motion clip: by suffix, and by content where that is common."""
    suffix = path.suffix.lower()
    if suffix not in READERS or suffix == ".asf" or path.name == OVERRIDES or not path.is_file():
        return False
    if suffix == ".npz":
        return is_amass(path)
    if suffix not in _SNIFFED:
        return True
    try:
        with path.open("rb") as stream:
            return b'"Frames"' in stream.read(2000)
    except OSError:
        return False


def motion_directories(option: Sequence[Path] | None) -> list[Path]:
    """Directories of `--motions`, else of SEGUE_MOTIONS, else the user's library."""
    if option:
        return list(option)
    if listed := os.environ.get("SEGUE_MOTIONS"):
        return [Path(entry) for entry in listed.split(os.pathsep) if entry]
    library = user_library()
    return [library] if library.is_dir() else []


def user_library() -> Path:
    """Where fetched and own clips of this user lie."""
    from platformdirs import user_data_path

    return user_data_path("segue", appauthor=False) / "motions"
