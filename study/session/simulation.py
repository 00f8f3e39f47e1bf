"""Participants without a window and without stimuli: the same session code, the same record."""

from collections.abc import Callable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from stimuli.errors import InputError
from stimuli.files import write_atomic
from stimuli.processes import mapped
from study.protocol.protocol import Protocol
from study.record.dataset import enrol, prepare, record_path, runs
from study.record.sidecar import sidecar_of
from study.record.table import COMMON, create
from study.session.conduct import rows_of_plan, run
from study.session.showing import ShownClip
from study.session.stage import Nowhere
from study.trials.observers import Simulated, simulated
from study.trials.plan import Plan, make_plan, session_seed
from study.trials.reading import protocol_of
from study.trials.tasks import TASKS
from study.trials.trial import ClipKey

WORTH_A_PROCESS = 20
LAST_NUMBER = 999_999


def unrendered(key: ClipKey) -> ShownClip:
    """A clip that is nowhere."""
    return ShownClip()


def plan_of(protocol: Protocol, references: dict[str, int], seed: int, participant: int) -> Plan:
    """The plan of the n-th simulated participant."""
    group = participant % TASKS[protocol.file.task].groups(protocol.file)
    return make_plan(protocol, references, session_seed(seed, participant), group=group)


def rows(plan: Plan, observer: Simulated | None = None) -> Iterator[dict[str, Any]]:
    """The rows of one simulated session, in memory; by default of the protocol's observer."""
    observer = observer or simulated(plan)
    for _, row in rows_of_plan(plan, _nowhere(plan), observer, unrendered):
        yield row


def simulate(
    protocol: Protocol,
    references: dict[str, int],
    participants: int,
    seed: int,
    data: Path,
    workers: int | None = None,
    progress: Callable[[int], None] | None = None,
    scheduler: str | None = None,
) -> list[Path]:
    """Simulate sessions into the data set `data`, on all cores; returns the records.

    A Dask `scheduler`'s address gives the sessions to its cluster, which sends their files back.

    Participants are named sim001 on; numbers that already have this task are passed over. A
    person's own seed goes by the number in the name, so that sim013 is one person for one `seed`,
    however many are simulated at a time.
    """
    numbers = _free_numbers(data, protocol.label, participants)
    prepare(data, protocol.file.lab)
    jobs = [(protocol.document, references, seed, data, n) for n in numbers]
    paths = []
    most = 1 + participants // WORTH_A_PROCESS
    done: Iterator[Path]
    if scheduler is None:
        done = mapped(_one, jobs, workers, most)
    else:
        sent = mapped(_elsewhere, jobs, workers, most, scheduler)
        done = (_kept(data, files) for files in sent)
    for path in done:
        paths.append(path)
        if progress:
            progress(len(paths))
    for number in numbers:
        enrol(data, _name(number), observer="simulated")
    return paths


def _name(number: int) -> str:
    return f"sim{number:03d}"


def _free_numbers(data: Path, label: str, count: int) -> list[int]:
    """The first numbers from 1 whose person has not done this task, nor is called as another."""
    there = {path.name.removeprefix("sub-") for path in data.glob("sub-*")}
    twins = {name.casefold() for name in there if name != name.casefold()}
    free = (
        n
        for n in range(1, LAST_NUMBER + 1)
        if not runs(data, _name(n), label) and _name(n) not in twins
    )
    numbers = list(islice(free, count))
    if len(numbers) < count:
        raise InputError(f"{data}: too many simulated participants; use another directory")
    return numbers


def _one(job: tuple[Any, dict[str, int], int, Path, int]) -> Path:
    """One session into its record; runs in a worker process."""

    document, references, seed, data, number = job
    protocol, name = protocol_of(document), _name(number)
    plan = plan_of(protocol, references, seed, number - 1)
    stage = _nowhere(plan)
    task = TASKS[protocol.file.task]
    path = record_path(data, name, protocol.label, 1)
    sidecar = sidecar_of(plan, task, observer="simulated", display=stage.display())
    record = create(path, (*COMMON, *task.columns), sidecar)
    run(plan, stage, record, simulated(plan), unrendered)
    return path


def _elsewhere(job: tuple[Any, dict[str, int], int, Path, int]) -> list[tuple[str, bytes]]:
    """The files of one session, the record last, from a machine without this data set."""
    document, references, seed, _, number = job
    with TemporaryDirectory(prefix="segue-") as folder:
        there = Path(folder)
        record = _one((document, references, seed, there, number))
        files = [path for path in there.rglob("*") if path.is_file() and path != record]
        return [(p.relative_to(there).as_posix(), p.read_bytes()) for p in (*files, record)]


def _kept(data: Path, files: Sequence[tuple[str, bytes]]) -> Path:
    """Write what came back from elsewhere; the record's path."""
    path = data
    for name, content in files:
        path = data / name
        write_atomic(path, content)
    return path


def _nowhere(plan: Plan) -> Nowhere:
    file = plan.protocol.file
    seconds = file.rehearsal.seconds if plan.rehearsal else file.stimuli.seconds
    return Nowhere(clip_seconds=seconds, gap=file.presentation.gap)
