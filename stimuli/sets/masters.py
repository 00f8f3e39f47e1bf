"""The files of a set's clips: put together from drawn frames, each whole or absent.

Beside each master lies a small document, written last, which says what the file holds: a clip is
there when both are and agree. The codec is what the documents say; a name says what is shown.
"""

import hashlib
import json
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from stimuli.errors import InputError, MachineError, UnwritableError
from stimuli.files import NO_ROOM, sha256, write_atomic
from stimuli.render.video import (
    MASTERS,
    RENDER_AGAIN,
    Pictures,
    decode_video,
    wanted_frames,
    write_packed,
)
from stimuli.sets.frames import DrawnFrame, FrameKey

CLIPS = "clips"
LOOKS = (".mp4", ".glb")  # what may lie beside a master


def master_path(out: Path, name: str, codec: str) -> Path:
    """Where the clip of that name lies, kept by that codec."""
    return out / CLIPS / f"{name}{MASTERS[codec].suffix}"


def document_path(out: Path, name: str) -> Path:
    """Where a clip's small document lies."""
    return out / CLIPS / f"{name}.json"


def kept(out: Path, name: str) -> dict[str, Any]:
    """What is known of a clip that lies there whole; empty where it does not."""
    try:
        told = json.loads(document_path(out, name).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    if not isinstance(told, dict):
        return {}
    codec = str(told.get("codec"))  # none in documents of manifest format 1
    path = master_path(out, name, codec) if codec in MASTERS else None
    whole = path is not None and path.is_file() and path.stat().st_size == told.get("bytes")
    return told if whole else {}


def masters_in(out: Path) -> list[Path]:
    """All masters that lie in a set, sorted."""
    suffixes = {master.suffix for master in MASTERS.values()}
    return sorted(path for path in (out / CLIPS).glob("*.*") if path.suffix in suffixes)


def beside_master(path: Path) -> list[Path]:
    """What lies beside a master for people to look at, under its name."""
    return [there for suffix in LOOKS if (there := path.with_suffix(suffix)).is_file()]


def frames_hash(digests: Iterable[bytes]) -> str:
    """The hash of a clip's pictures: SHA-256 of the SHA-256 of each frame's RGB bytes, in order.

    Another machine's rasteriser may shade the edge of a figure otherwise, so that this hash tells
    whether a clip was damaged, not whether two clips are one: their names do.
    """
    whole = hashlib.sha256()
    for digest in digests:
        whole.update(digest)
    return whole.hexdigest()


def clip_content(path: Path, told: str | None) -> bytes:
    """What the file of a clip holds, whose SHA-256 the manifest has `told` (None: it did not).

    InputError where the file is damaged, or another one lies under its name.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(
            f"{path}: expected a clip of the set, found {error.strerror or error}.\n{RENDER_AGAIN}"
        ) from error
    if told is not None and hashlib.sha256(content).hexdigest() != told:
        raise InputError(
            f"{path}: expected the clip that the set was built with, found another file or "
            f"a damaged one: it was exchanged, changed or cut short.\n{RENDER_AGAIN}"
        )
    return content


def clip_frames(entry: Any, wanted: Sequence[int] | None = None) -> Iterator[Pictures]:
    """The frames (height, width, 3) of a manifest's clip one by one: all, or those wanted.

    InputError as for `read_clip`; of a large clip no more than a frame is held.
    """
    content = clip_content(entry.path, entry.document.get("file_sha256"))
    numbers = range(entry.frames) if wanted is None else wanted
    return map(np.ascontiguousarray, wanted_frames(entry.path, content, numbers, entry.frames))


def read_clip(entry: Any) -> Pictures:
    """(F, height, width, 3) frames of a manifest's clip, as the set was built with.

    InputError where the file is damaged, or another one lies under its name.
    """
    content = clip_content(entry.path, entry.document.get("file_sha256"))
    frames = decode_video(entry.path, content)
    if len(frames) != entry.frames:
        raise InputError(
            f"{entry.path}: expected {entry.frames} frames, found {len(frames)}: it was cut "
            f"short.\n{RENDER_AGAIN}"
        )
    return frames


class Assembly:
    """Clips put together from frames that come in any order; each is written once it is whole.

    `clips` has the frames of each clip in order. A frame is held until no clip needs it.
    """

    def __init__(
        self,
        out: Path,
        codec: str,
        fps: float,
        clips: Mapping[str, tuple[tuple[int, int], Sequence[FrameKey]]],
    ) -> None:
        self._out, self._codec, self._fps, self._clips = out, codec, fps, clips
        self._frames: dict[FrameKey, DrawnFrame] = {}
        self._drivers: dict[FrameKey, str] = {}
        self._lacking = {name: len(set(keys)) for name, (_, keys) in clips.items()}
        self._wanted = Counter(key for _, keys in clips.values() for key in set(keys))
        self._holders: dict[FrameKey, list[str]] = {}
        for name, (_, keys) in clips.items():
            for key in set(keys):
                self._holders.setdefault(key, []).append(name)

    def add(self, frame: DrawnFrame, driver: str) -> list[str]:
        """Take a frame; the names of the clips that it made whole, which are written."""
        self._frames[frame.key], self._drivers[frame.key] = frame, driver
        whole = []
        for name in self._holders[frame.key]:
            self._lacking[name] -= 1
            if not self._lacking[name]:
                self._write(name)
                whole.append(name)
        return whole

    def _write(self, name: str) -> None:
        size, keys = self._clips[name]
        path = master_path(self._out, name, self._codec)
        frames = [self._frames[key] for key in keys]
        try:
            packed = (frame.packed for frame in frames)
            write_packed(path, MASTERS[self._codec], size, packed, self._fps)
            document = {
                "frames": len(frames),
                "frames_sha256": frames_hash(frame.sha256 for frame in frames),
                "bytes": path.stat().st_size,
                "file_sha256": sha256(path),
                "codec": self._codec,
                "drivers": sorted({self._drivers[key] for key in keys}),
            }
            write_atomic(document_path(self._out, name), json.dumps(document))
        except UnwritableError as error:
            raise _unwritten(path, error) from error
        for codec in MASTERS:
            if codec != self._codec:
                master_path(self._out, name, codec).unlink(missing_ok=True)
        for key in set(keys):
            self._wanted[key] -= 1
            if not self._wanted[key]:
                del self._frames[key], self._drivers[key]


def _unwritten(path: Path, error: UnwritableError) -> MachineError:
    """A clip that could not be written; those rendered so far are kept."""
    cause = error.__cause__
    why = getattr(cause, "strerror", None) or cause
    if isinstance(cause, OSError) and cause.errno in NO_ROOM:
        return MachineError(
            f"{path.parent}: expected room for a clip, found none ({why}); the clips rendered so "
            "far are kept.\nMake room on that disk, and run it again"
        )
    return MachineError(
        f"{path}: expected a place for a clip, found: {why}; the clips rendered so far are "
        "kept.\nMend that, and run it again"
    )
