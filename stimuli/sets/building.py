"""Building a set: what is missing is rendered, what is there is kept, nothing is half-written.

A clip's name is the hash of what it is made of (`naming`), the same on any machine. It counts as
there when its file and the small document beside it are (`masters`); so an interrupted build goes
on where it stopped, and a change of anything that shows gives a new name. Clips of earlier builds
stay, since records may refer to them; `prune` removes them.
"""

import json
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from stimuli.errors import InputError, InputWarning, UnwritableError
from stimuli.files import refusals_name, write_atomic
from stimuli.motion.library import Library
from stimuli.render.device import check_device
from stimuli.render.video import ARCHIVE, FAST
from stimuli.sets.frames import DrawJob, DrawnFrame, FrameKey, jobs_of
from stimuli.sets.group import PlannedClip, PlannedGroup, plan_groups
from stimuli.sets.manifest import (
    FORMAT,
    MANIFEST,
    Manifest,
    from_document,
    load_manifest,
    set_hash,
)
from stimuli.sets.masters import (
    CLIPS,
    Assembly,
    beside_master,
    document_path,
    kept,
    master_path,
    masters_in,
)
from stimuli.sets.plan import ResolvedPairing
from stimuli.sets.sources import changed_motions
from stimuli.sets.spec import SetSpec
from stimuli.sets.workers import Crew, draw_all

FILE_KEYS = ("frames", "frames_sha256", "file_sha256", "bytes", "codec", "drivers")
ClipProgress = Callable[[int, int], None]


@dataclass(frozen=True)
class Inventory:
    """What a build would do: clips wanted, those to render, and files of earlier builds."""

    wanted: int
    missing: tuple[str, ...]
    stale: tuple[Path, ...]
    resolved: tuple[ResolvedPairing, ...] = ()


def build(
    spec: SetSpec,
    library: Library,
    out: Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    device: str = "auto",
    archive: bool = False,
    progress: ClipProgress | None = None,
) -> Manifest:
    """Render what is missing of a set and write its manifest.

    `workers` processes draw, or those of a Dask `scheduler`; on the `device` of
    `stimuli.render.device.DEVICES`. An `archive` keeps FFV1, which counts as there without it
    too. `progress(done, total)` is told of each clip. InputError for all input that cannot be
    used, before anything is rendered, and where another build of the same set is going on.
    """
    check_device(device)
    groups = plan_groups(spec, library)
    codec = ARCHIVE if archive else FAST
    crew = Crew(workers, scheduler, device)
    try:
        with _locked(out):
            _tell_changed(out, groups)
            return _built(spec, groups, out, codec, crew, progress or (lambda done, total: None))
    except UnwritableError:
        if _inventory(groups, out, codec).missing or not _holds(out, _text(spec, groups, out)):
            raise
        return load_manifest(out)  # whole already, in a folder that is for reading


def inventory(spec: SetSpec, library: Library, out: Path, *, archive: bool = False) -> Inventory:
    """What `build` would do, without doing it; refuses what it would refuse."""
    groups = plan_groups(spec, library)
    return _inventory(groups, out, ARCHIVE if archive else FAST)


def stale_clips(manifest: Manifest) -> tuple[Path, ...]:
    """Clips of earlier builds that lie beside those of the manifest."""
    named = {entry.hash for entry in manifest.clips}
    return tuple(path for path in masters_in(manifest.directory) if path.stem not in named)


def prune(manifest: Manifest) -> int:
    """Remove clips of earlier builds and what lies beside them; returns how many clips."""
    stale = stale_clips(manifest)
    for path in stale:
        for beside in beside_master(path):
            beside.unlink()
        path.unlink()
        document_path(manifest.directory, path.stem).unlink(missing_ok=True)
    return len(stale)


def _inventory(groups: Sequence[PlannedGroup], out: Path, codec: str) -> Inventory:
    wanted = dict.fromkeys(clip.hash for group in groups for clip in group.clips)
    missing = tuple(name for name in wanted if not _serves(kept(out, name), codec))
    stale = tuple(path for path in masters_in(out) if path.stem not in wanted)
    return Inventory(len(wanted), missing, stale, tuple(group.resolved for group in groups))


def _serves(held: Mapping[str, Any], codec: str) -> bool:
    """Whether a clip is there, kept so that nobody who wants `codec` needs it again."""
    return bool(held) and held["codec"] in (codec, ARCHIVE)


@contextmanager
def _locked(out: Path) -> Iterator[None]:
    """The set's folder, for this build alone."""
    from filelock import FileLock, Timeout

    lock = FileLock(out / ".lock")
    with refusals_name(out / MANIFEST):
        (out / CLIPS).mkdir(parents=True, exist_ok=True)
        try:
            lock.acquire(timeout=0)
        except Timeout:
            raise InputError(
                f"{out}: expected no other build of this set, found one going on.\n"
                "Wait until it ends."
            ) from None
    try:
        yield
    finally:
        lock.release()


def _built(
    spec: SetSpec,
    groups: Sequence[PlannedGroup],
    out: Path,
    codec: str,
    crew: Crew,
    progress: ClipProgress,
) -> Manifest:
    _tidy(out)
    missing = set(_inventory(groups, out, codec).missing)
    jobs, clips = _work(groups, missing)
    assembly = Assembly(out, codec, spec.fps, clips)
    finished = 0
    progress(0, len(clips))

    def taken(frames: Sequence[DrawnFrame], driver: str) -> None:
        nonlocal finished
        for frame in frames:
            for _ in assembly.add(frame, driver):
                finished += 1
                progress(finished, len(clips))

    if jobs:
        try:
            draw_all(jobs, {group.name: group.scenery for group in groups}, codec, crew, taken)
        finally:
            _tidy(out)
    text = _text(spec, groups, out)
    if not _holds(out, text):
        write_atomic(out / MANIFEST, text)
    _tell_mixed(groups, out)
    # What a later `load_manifest` gives: tuples and lists are one thing on the disk.
    return replace(from_document(out, json.loads(text)), rendered=len(clips))


def _work(
    groups: Sequence[PlannedGroup], missing: set[str]
) -> tuple[list[DrawJob], dict[str, tuple[tuple[int, int], list[FrameKey]]]]:
    """What is to be drawn, and of which frames each missing clip is put together."""
    jobs: list[DrawJob] = []
    clips: dict[str, tuple[tuple[int, int], list[FrameKey]]] = {}
    for group in groups:
        wanted = {
            clip.hash: (clip.bones, clip.ground)
            for clip in group.clips
            if clip.hash in missing - set(clips)
        }
        drawn = ((name, *shown) for name, shown in wanted.items())
        for name, keys, job in jobs_of(group.scenery, drawn):
            clips[name] = (group.scenery.size, keys)
            if job.keys:
                jobs.append(job)
    return jobs, clips


def _tidy(out: Path) -> None:
    """Remove what an ended build left half-written; the lock is held, so nobody is writing."""
    for folder in (out, out / CLIPS):
        for path in folder.glob(".*.part*"):
            path.unlink(missing_ok=True)


def _tell_changed(out: Path, groups: Sequence[PlannedGroup]) -> None:
    """Say which motions are no longer those that the set in that folder was rendered from."""
    try:
        before = json.loads((out / MANIFEST).read_text(encoding="utf-8"))["pairings"]
        changed = changed_motions(before, {group.name: group.document for group in groups})
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return  # no manifest, or one that nobody can read: the set is built anew
    if changed:
        warnings.warn(
            f"{out}: {', '.join(changed)} changed since the set was rendered; clips of the motion "
            "as it is now are rendered, and records made so far tell of the other ones",
            InputWarning,
            stacklevel=4,
        )


def _tell_mixed(groups: Sequence[PlannedGroup], out: Path) -> None:
    """Say which groups were drawn by more than one driver: their clips differ at edges."""
    for group in groups:
        drivers = {name for clip in group.clips for name in kept(out, clip.hash)["drivers"]}
        if len(drivers) > 1:
            warnings.warn(
                f"{out}, {group.name}: expected clips drawn by one driver, found those of "
                f"{' and '.join(sorted(drivers))}, which shade edges otherwise; render them into "
                "an empty folder",
                InputWarning,
                stacklevel=4,
            )


def _holds(out: Path, text: str) -> bool:
    try:
        return (out / MANIFEST).read_text(encoding="utf-8") == text
    except (OSError, ValueError):
        return False


def _text(spec: SetSpec, groups: Sequence[PlannedGroup], out: Path) -> str:
    """The manifest of a set whose clips are all there."""
    document: dict[str, Any] = {
        "format": FORMAT,
        "name": spec.name,
        "hash": "",
        "fps": spec.fps,
        "seconds": spec.seconds,
        "frames": spec.frames,
        "width": groups[0].scenery.look.width,
        "height": groups[0].scenery.look.height,
        "background": list(spec.appearance.background),
        "appearance": asdict(groups[0].scenery.look),
        "specification": spec.specification,
        "pairings": {group.name: group.document for group in groups},
        "clips": [_clip(clip, out) for group in groups for clip in group.clips],
    }
    document["hash"] = set_hash(document)
    return json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _clip(clip: PlannedClip, out: Path) -> dict[str, Any]:
    held = kept(out, clip.hash)
    return {
        "hash": clip.hash,
        "file": str(master_path(Path(), clip.hash, held["codec"]).as_posix()),
        **clip.document,
        **{key: held[key] for key in FILE_KEYS},
    }
