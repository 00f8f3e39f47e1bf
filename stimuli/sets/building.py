"""Building a set: what is missing is rendered, what is there is kept, nothing is half-written.

A clip's name is the hash of what it is made of (`naming`), the same on any machine. It counts as
there when its file and the small document beside it are, the document being written last; so an
interrupted build goes on where it stopped, and a change of anything that shows gives a new name.
Clips of earlier builds stay, since records may refer to them; `prune` removes them.
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from stimuli.errors import InputError
from stimuli.files import write_atomic
from stimuli.motion.library import Library
from stimuli.sets.group import PlannedClip, PlannedGroup, plan_groups
from stimuli.sets.manifest import FORMAT, MANIFEST, Manifest, from_document, set_hash
from stimuli.sets.spec import SetSpec
from stimuli.sets.workers import Rendered, RenderJob, render_all

CLIPS = "clips"
ClipProgress = Callable[[int, int], None]


@dataclass(frozen=True)
class Inventory:
    """What a build would do: clips wanted, those to render, and files of earlier builds."""

    wanted: int
    missing: tuple[str, ...]
    stale: tuple[Path, ...]


def build(
    spec: SetSpec,
    library: Library,
    out: Path,
    *,
    workers: int | None = None,
    progress: ClipProgress | None = None,
) -> Manifest:
    """Render what is missing of a set in `workers` processes and write its manifest.

    `progress(done, total)` is told of each clip. InputError for input that cannot be used, before
    anything is rendered, and where another build of the same set is going on.
    """
    from filelock import FileLock, Timeout

    groups = plan_groups(spec, library)
    (out / CLIPS).mkdir(parents=True, exist_ok=True)
    try:
        with FileLock(out / ".lock", timeout=0):
            return _built(spec, groups, out, workers, progress or (lambda done, total: None))
    except Timeout:
        raise InputError(
            f"{out}: expected no other build of this set, found one going on.\nWait until it ends."
        ) from None


def inventory(spec: SetSpec, library: Library, out: Path) -> Inventory:
    """What `build` would do, without doing it."""
    groups = plan_groups(spec, library)
    return _inventory(groups, out)


def stale_clips(manifest: Manifest) -> tuple[Path, ...]:
    """Clips of earlier builds that lie beside those of the manifest."""
    named = {entry.hash for entry in manifest.clips}
    there = sorted((manifest.directory / CLIPS).glob("*.mkv"))
    return tuple(path for path in there if path.stem not in named)


def prune(manifest: Manifest) -> int:
    """Remove clips of earlier builds; returns how many."""
    stale = stale_clips(manifest)
    for path in stale:
        path.unlink()
        path.with_suffix(".json").unlink(missing_ok=True)
    return len(stale)


def _inventory(groups: Sequence[PlannedGroup], out: Path) -> Inventory:
    wanted = {clip.hash for group in groups for clip in group.clips}
    missing = tuple(name for name in dict.fromkeys(_order(groups)) if not _is_there(out, name))
    stale = [path for path in sorted((out / CLIPS).glob("*.mkv")) if path.stem not in wanted]
    return Inventory(len(wanted), missing, tuple(stale))


def _order(groups: Sequence[PlannedGroup]) -> list[str]:
    return [clip.hash for group in groups for clip in group.clips]


def _built(
    spec: SetSpec,
    groups: list[PlannedGroup],
    out: Path,
    workers: int | None,
    progress: ClipProgress,
) -> Manifest:
    _tidy(out)
    missing = set(_inventory(groups, out).missing)
    jobs = {
        clip.hash: RenderJob(
            _file(out, clip.hash),
            group.body.skin,
            clip.bones,
            spec.fps,
            group.camera,
            group.look,
            clip.ground,
        )
        for group in groups
        for clip in group.clips
        if clip.hash in missing
    }
    finished = 0
    progress(0, len(jobs))

    def done(result: Rendered) -> None:
        nonlocal finished
        finished += 1
        kept = {
            "frames": result.frames,
            "frames_sha256": result.frames_sha256,
            "bytes": result.path.stat().st_size,
        }
        write_atomic(result.path.with_suffix(".json"), json.dumps(kept))
        progress(finished, len(jobs))

    if jobs:
        try:
            render_all(list(jobs.values()), workers, done)
        finally:
            _tidy(out)
    text = json.dumps(_document(spec, groups, out), indent=1, ensure_ascii=False, allow_nan=False)
    text += "\n"
    path = out / MANIFEST
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        write_atomic(path, text)
    # What a later `load_manifest` gives: tuples and lists are one thing on the disk.
    return replace(from_document(out, json.loads(text)), rendered=len(jobs))


def _tidy(out: Path) -> None:
    """Remove what an ended build left half-written; the lock is held, so nobody is writing."""
    for folder in (out, out / CLIPS):
        for path in folder.glob(".*.part*"):
            path.unlink(missing_ok=True)


def _file(out: Path, name: str) -> Path:
    return out / CLIPS / f"{name}.mkv"


def _is_there(out: Path, name: str) -> bool:
    """Whether a clip was written whole: its document agrees with its file."""
    kept, path = _kept(out, name), _file(out, name)
    return bool(kept) and path.is_file() and path.stat().st_size == kept.get("bytes")


def _kept(out: Path, name: str) -> dict[str, Any]:
    try:
        kept = json.loads(_file(out, name).with_suffix(".json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return kept if isinstance(kept, dict) else {}


def _document(spec: SetSpec, groups: Sequence[PlannedGroup], out: Path) -> dict[str, Any]:
    document: dict[str, Any] = {
        "format": FORMAT,
        "name": spec.name,
        "hash": "",
        "fps": spec.fps,
        "seconds": spec.seconds,
        "frames": spec.frames,
        "width": groups[0].look.width,
        "height": groups[0].look.height,
        "background": list(spec.appearance.background),
        "appearance": asdict(groups[0].look),
        "specification": spec.specification,
        "pairings": {group.name: group.document for group in groups},
        "clips": [_clip(clip, out) for group in groups for clip in group.clips],
    }
    document["hash"] = set_hash(document)
    return document


def _clip(clip: PlannedClip, out: Path) -> dict[str, Any]:
    kept = _kept(out, clip.hash)
    return {
        "hash": clip.hash,
        "file": f"{CLIPS}/{clip.hash}.mkv",
        **clip.document,
        "frames": kept["frames"],
        "frames_sha256": kept["frames_sha256"],
    }
