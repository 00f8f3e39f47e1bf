"""A session with a participant: its stimuli, its record (new or resumed), its window."""

import secrets
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from filelock import FileLock, Timeout

from stimuli.errors import InputError
from study.protocol.protocol import Protocol
from study.protocol.rendered import again_command, check_rendered
from study.protocol.sets import references_of_manifest
from study.record.dataset import (
    check_participant,
    check_twin,
    enrol,
    enrolled,
    finished_groups,
    keep_stimulus,
    prepare,
    record_path,
    runs,
    source_folder,
    unfinished,
)
from study.record.sidecar import sidecar_of
from study.record.table import COMMON, MISSING, Record, create
from study.session.conduct import run
from study.session.showing import ShownClip
from study.session.stage import Stage
from study.trials.observers import simulated
from study.trials.plan import Plan, examples_of, make_plan
from study.trials.tasks import TASKS, Task
from study.trials.trial import ClipKey, Outcome, Trial

if TYPE_CHECKING:
    from stimuli.sets import Manifest

OBSERVERS = ("human", "simulated")


Hears = Callable[[Trial, Outcome], None]
OpenStage = Callable[["Request", Plan, Task, "Manifest", Path], Stage]


@dataclass(frozen=True)
class Request:
    """What was asked for: who, where the data go, and how the session is shown.

    `restart` leaves an unfinished run as it is, without reading it.
    """

    participant: str
    data: Path
    observer: str = "human"
    rehearsal: bool = False
    pace: float = 1.0
    seed: int | None = None
    restart: bool = False
    screen: int = 0
    windowed: bool = False
    lost: str = ""  # what is said when the screen goes away
    battery: Mapping[str, object] | None = None  # of which this is a part: its name, order, place


def check(request: Request, protocol: Protocol) -> None:
    """Refuse a request that cannot be run, before anything is written or opened."""
    check_participant(request.participant)
    check_twin(request.data, request.participant)
    enrolled(request.data)  # which refuses a table that nobody could be added to
    if not 0 < request.pace < float("inf"):
        raise InputError(f"--pace: expected a number above 0, found {request.pace}")
    if request.seed is not None and request.seed < 0:
        raise InputError(f"--seed: expected a whole number, 0 or more, found {request.seed}")
    if request.observer == "simulated" and protocol.file.observer is None:
        raise InputError(
            f"{protocol.name}: expected a table [observer] for a simulated observer, found none"
        )


def run_session(
    request: Request,
    protocol: Protocol,
    manifest: "Manifest",
    resume: Callable[[Record], bool],
    open_stage: OpenStage,
    told: Hears = lambda trial, outcome: None,
) -> Record:
    """Run one session and return its record; `resume` is asked about an unfinished one.

    Raises InputError when another session holds this participant's lock, or when the stimulus set
    lacks clips; raises SessionLeft when somebody left. The record is never half
    written. `open_stage` is called once all is known to be there.
    """
    check(request, protocol)
    lock_path = source_folder(request.data, request.participant) / f"{protocol.label}.lock"
    try:
        with FileLock(lock_path, timeout=0):
            return _locked(request, protocol, manifest, resume, open_stage, told)
    except Timeout as error:
        raise InputError(
            f"{lock_path}: expected no other session of {request.participant} in this study, found "
            "one running; close it first"
        ) from error


def _locked(
    request: Request,
    protocol: Protocol,
    manifest: "Manifest",
    resume: Callable[[Record], bool],
    open_stage: OpenStage,
    told: Hears = lambda trial, outcome: None,
) -> Record:
    task = TASKS[protocol.file.task]
    earlier = None
    if not request.restart:
        earlier = unfinished(request.data, request.participant, protocol, request.rehearsal)
    if earlier is not None and not resume(earlier):
        earlier = None
    seed = request.seed
    if earlier is not None:
        _check_resumable(earlier, request, protocol, manifest)
        seed = int(earlier.sidecar["Seed"])
    elif seed is None:
        seed = secrets.randbits(32)
    check_rendered(protocol, manifest, request.rehearsal)
    group = int(earlier.sidecar.get("Group", 0)) if earlier else _group(request, protocol, seed)
    lengths = references_of_manifest(protocol, manifest)
    plan = make_plan(protocol, lengths, seed, request.rehearsal, group)
    _check_clips(plan, manifest)
    _check_sources(plan, manifest)
    observer = simulated(plan) if request.observer == "simulated" else None
    path = earlier.path if earlier else _new_path(request, protocol)
    stage = open_stage(request, plan, task, manifest, _flip_log(request, path))
    try:
        record = earlier or _new_record(request, plan, task, manifest, stage, path)
        if earlier is not None:
            resumed = [*record.sidecar.get("ResumedOn", []), stage.display()]
            record.save_sidecar(ResumedOn=resumed)

        first, _ = shown_frames(plan, manifest)

        def shown(key: ClipKey) -> ShownClip:
            clip = entry(manifest, key)
            keep_stimulus(request.data, clip.hash, clip.document)
            mixed = clip.document.get("mixed")
            return ShownClip(clip.hash, mixed and (mixed[0] - first, mixed[1] - first))

        run(plan, stage, record, observer, shown, told)
    finally:
        stage.close()
    return record


def _group(request: Request, protocol: Protocol, seed: int) -> int:
    """The group that the fewest have finished so far, of several such one by the seed."""
    groups = TASKS[protocol.file.task].groups(protocol.file)
    done = finished_groups(request.data, protocol.label)
    fewest = min(done[group] for group in range(groups))
    open_ones = [group for group in range(groups) if done[group] == fewest]
    return open_ones[seed % len(open_ones)]


def _new_path(request: Request, protocol: Protocol) -> Path:
    number = max(runs(request.data, request.participant, protocol.label), default=0) + 1
    return record_path(request.data, request.participant, protocol.label, number)


def _flip_log(request: Request, record: Path) -> Path:
    name = record.name.replace("_beh.tsv", "_flips.tsv")
    return source_folder(request.data, request.participant) / name


def _new_record(
    request: Request, plan: Plan, task: Task, manifest: "Manifest", stage: Stage, path: Path
) -> Record:
    prepare(request.data, plan.protocol.file.lab)
    enrol(request.data, request.participant, observer=request.observer)
    sidecar = sidecar_of(
        plan,
        task,
        observer=request.observer,
        display=stage.display(),
        pace=request.pace,
        stimulus_set_hash=manifest.hash,
        **({"Battery": dict(request.battery)} if request.battery else {}),
    )
    return create(path, (*COMMON, *task.columns), sidecar)


def _check_resumable(
    record: Record, request: Request, protocol: Protocol, manifest: "Manifest"
) -> None:
    """A session goes on only as it began."""
    now = {
        "ProtocolHash": protocol.hash,
        "StimulusSetHash": manifest.hash,
        "Observer": request.observer,
        "Pace": request.pace,
    }
    for key, value in now.items():
        found = record.sidecar.get(key, MISSING)
        if found != value:
            raise InputError(
                f"{record.path.name}: began with {key} {found}, now it is {value}; "
                "restore that, or start a new run with --restart"
            )


def _check_clips(plan: Plan, manifest: "Manifest") -> None:
    """Every clip that the plan may show lies in the set, or the session does not start."""
    lacking = [key for key in clips_of(plan) if not _exists(manifest, key)]
    if lacking:
        names = ", ".join(f"{k.motion} {k.method or k.length}" for k in lacking[:4])
        raise InputError(
            f"{manifest.directory}: expected all clips of {plan.protocol.name}, found none for "
            f"{names}{' and more' if len(lacking) > 4 else ''};\n"
            f"run `{again_command(plan.protocol, manifest.directory)}`"
        )
    for clip in (entry(manifest, key) for key in clips_of(plan)):
        wanted, found = clip.document.get("bytes"), clip.path.stat().st_size
        if wanted not in (None, found):  # what it holds is looked at when it is decoded
            raise InputError(
                f"{clip.path}: expected {wanted} bytes, as the set was rendered, found {found}: it "
                "was cut short or exchanged;\n"
                f"run `{again_command(plan.protocol, manifest.directory)}`"
            )


def _check_sources(plan: Plan, manifest: "Manifest") -> None:
    """The motions that the set was rendered from are still what their files hold."""
    from stimuli.sets.sources import changed_files

    names = {motion.name for motion in plan.motions}
    shown = {name: told for name, told in manifest.pairings.items() if name in names}
    if changed := changed_files(shown):
        raise InputError(
            f"{manifest.directory}: expected the motions that it was rendered from, found "
            f"{', '.join(changed)} changed since;\nput the files back as they were, or run "
            f"`{again_command(plan.protocol, manifest.directory)}`"
        )


def clips_of(plan: Plan) -> list[ClipKey]:
    """All clips that a session of this plan may show."""
    keys = [key for _, key in examples_of(plan)]
    for motion in plan.motions:
        keys += [ClipKey(motion.name, method=method) for method in plan.protocol.file.methods]
        if motion.reference is not None:
            k = motion.reference
            lengths = [k, *(k - d for d in motion.shorter), *(k + d for d in motion.longer)]
            keys += [ClipKey(motion.name, length=length) for length in lengths]
    return keys


def shown_frames(plan: Plan, manifest: "Manifest") -> tuple[int, int]:
    """The first of the frames of each clip that are shown, and how many these are.

    A rehearsal shows the middle, where the transition is.
    """
    seconds = manifest.seconds
    if plan.rehearsal:
        seconds = min(plan.protocol.file.rehearsal.seconds, seconds)
    count = round(seconds * manifest.fps)
    return max((manifest.frames - count) // 2, 0), count


def entry(manifest: "Manifest", key: ClipKey) -> Any:
    """The manifest's entry of a clip."""
    if key.method is not None:
        return manifest.clip(key.motion, method=key.method)
    return manifest.clip(key.motion, length=key.length)


def _exists(manifest: "Manifest", key: ClipKey) -> bool:
    try:
        return bool(entry(manifest, key).path.is_file())
    except (InputError, KeyError):
        return False
