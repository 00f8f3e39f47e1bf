"""`CLIP:FRAME` on the command line, and the clips that it names."""

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from stimuli.motion import Clip, Library, Motion


@dataclass(frozen=True, eq=False)
class Point:
    """A frame of a clip; a loop is unrolled so that a blend has room around it."""

    clip: "Clip"
    frame: int
    motion: "Motion"
    place: int  # of that frame in `motion`


def add_point_arguments(parser: argparse.ArgumentParser, remark: str = "") -> None:
    """A:i and B:j, the frames where a transition leaves one clip and enters another."""
    parser.add_argument("from_point", metavar="A:i", help=f"clip and frame to leave{remark}")
    parser.add_argument("to_point", metavar="B:j", help="clip and frame to enter")


def open_library(motions: list[Path] | None) -> "Library":
    """The library of the directories given, or of the usual ones."""
    from stimuli.motion import Library, motion_directories

    return Library(motion_directories(motions))


def names_frame(text: str) -> bool:
    """Whether a word of the command line is CLIP:FRAME; a path may have colons of its own."""
    return split_point(text)[1] is not None


def split_point(text: str) -> tuple[str, int | None]:
    """The clip that a word of the command line names, and its frame where it names one."""
    from stimuli.motion.formats.words import whole_number

    name, colon, number = text.rpartition(":")
    frame = whole_number(number) if colon else None
    return (text, None) if frame is None else (name, frame)


def open_point(library: "Library", text: str) -> Point:
    """The frame that `CLIP:FRAME` names; InputError when there is none such."""
    from stimuli.errors import InputError
    from stimuli.motion.formats.source import shown
    from stimuli.transition import with_room

    name, frame = split_point(text)
    if frame is None:
        raise InputError(f"{shown(text, 200)}: expected CLIP:FRAME, such as walk:42.")
    clip = library.load(name)
    if frame >= len(clip.motion):
        raise InputError(
            f"{text}: expected a frame of the working clip (30 a second), "
            f"0 to {len(clip.motion) - 1}, found {frame}."
        )
    motion, place = with_room(clip.motion, frame)
    return Point(clip, frame, motion, place)


def is_directory(name: str) -> bool:
    """Whether a name is that of a directory; one longer than any file's is not."""
    try:
        return Path(name).is_dir()
    except OSError:
        return False


def open_all(motions: list[Path] | None, names: list[str]) -> list[list["Clip"]]:
    """For each name, its clip, or all clips of a directory that have the first one's hierarchy.

    Clips that are refused or of another hierarchy are named on standard error and left out.
    """
    import sys

    from stimuli.errors import InputError

    library = open_library(motions)
    opened, notes = _loaded(library, [_paths(library, name) for name in names])
    for note in notes:
        print(note, file=sys.stderr)
    if unusable := [name for name, clips in zip(names, opened, strict=True) if not clips]:
        raise InputError(f"{unusable[0]}: expected motion clips, found none that can be used.")
    return opened


def _paths(library: "Library", name: str) -> list[Path]:
    """The clips of the directory of that name, or the one clip."""
    from stimuli.motion.library import clips_under

    return clips_under(Path(name)) if is_directory(name) else [library.find(name)]


def _loaded(library: "Library", groups: list[list[Path]]) -> tuple[list[list["Clip"]], list[str]]:
    """Of each group the clips of the very first one's hierarchy, and why others are left out.

    A bar shows how many are read.
    """
    from stimuli.errors import InputError
    from study.cli.common import progress

    done, first, opened, notes = 0, None, [], []
    with progress(sum(map(len, groups)), "reading clips") as step:
        for paths in groups:
            clips = []
            for path in paths:
                try:
                    clip = library.load(path)
                    first = first or clip
                    if clip.motion.skeleton.same_hierarchy(first.motion.skeleton):
                        clips.append(clip)
                    else:
                        notes.append(f"{path}: another hierarchy than {first.name}: left out")
                except InputError as error:
                    notes.append(str(error))
                done += 1
                step(done)
            opened.append(clips)
    return opened, notes


def tell_warnings(*clips: "Clip") -> None:
    """Warnings of the clips, on standard error."""
    import sys

    for clip in dict.fromkeys(clips):
        for warning in clip.warnings:
            print(f"{clip.path}: {warning}", file=sys.stderr)
