"""What a session knows of a stimulus set: one JSON document beside the clips.

`MANIFEST.md`, in this folder, says what every key means.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stimuli.errors import InputError
from stimuli.sets.naming import digest

FORMAT = 2
READ = (1, FORMAT)
MANIFEST = "manifest.json"


@dataclass(frozen=True, eq=False)
class ClipEntry:
    """One clip: its file, what it shows, and its whole entry in the manifest."""

    hash: str
    path: Path
    motion: str
    method: str | None
    length: int
    frames: int
    frames_sha256: str
    document: Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class Manifest:
    """A built set."""

    directory: Path
    name: str
    hash: str
    fps: int
    seconds: float
    frames: int
    size: tuple[int, int]  # width, height
    background: tuple[float, float, float]
    specification: str
    pairings: Mapping[str, Mapping[str, Any]]
    clips: tuple[ClipEntry, ...]
    rendered: int = 0  # clips rendered by the build that returned this

    def clip(
        self, motion: str, *, length: int | None = None, method: str | None = None
    ) -> ClipEntry:
        """The clip of a motion with that length or method; InputError where there is none."""
        for entry in self.clips:
            if entry.motion == motion and (
                entry.method == method if method is not None else entry.length == length
            ):
                return entry
        wanted = f"method {method}" if method is not None else f"length {length}"
        raise InputError(
            f"{self.directory}: expected a clip of {motion} with {wanted}, found none.\n"
            "Complete the stimulus set with segue render."
        )


def load_manifest(directory: Path) -> Manifest:
    """The set in a directory; InputError where there is none, or its manifest cannot be read."""
    path = directory / MANIFEST
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise InputError(
            f"{directory}: expected a stimulus set, found no {MANIFEST}.\n"
            "Build it with segue render, or name another with --stimuli."
        ) from error
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: expected a manifest, found a damaged one ({error}).") from error
    if not isinstance(document, dict) or document.get("format") not in READ:
        raise InputError(
            f"{path}: expected a manifest of format {' or '.join(map(str, READ))}, found another.\n"
            "Build the set again with segue render."
        )
    return from_document(directory, document)


def from_document(directory: Path, document: Mapping[str, Any]) -> Manifest:
    """The manifest that a document describes; InputError where it lacks a key."""
    try:
        clips = tuple(_entry(directory, clip) for clip in document["clips"])
        return Manifest(
            directory, document["name"], document["hash"], document["fps"], document["seconds"],
            document["frames"], (document["width"], document["height"]),
            tuple(document["background"]), document["specification"], document["pairings"], clips,
        )  # fmt: skip
    except (KeyError, TypeError) as error:
        raise InputError(
            f"{directory / MANIFEST}: expected the key {error} of a manifest, found none.\n"
            "Build the set again with segue render."
        ) from error


def _entry(directory: Path, clip: Mapping[str, Any]) -> ClipEntry:
    return ClipEntry(
        clip["hash"], directory / clip["file"], clip["motion"], clip["method"], clip["length"],
        clip["frames"], clip["frames_sha256"], clip,
    )  # fmt: skip


def set_hash(document: Mapping[str, Any]) -> str:
    """Hash of what a set shows: the names of its clips, in order, and what each is of.

    As names it is the same on any machine and wherever clips and sets lie. What one machine drew,
    pixel for pixel, is the `frames_sha256` of each clip.
    """
    shown = [[clip["motion"], clip["method"], clip["length"], clip["hash"]]
             for clip in document["clips"]]  # fmt: skip
    return digest({"clips": shown, "fps": document["fps"]})
