"""Participants without a window and without stimuli: the same session code, the same record."""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from stimuli.errors import InputError
from study.dataset import enrol, prepare, record_path, runs
from study.observers import simulated
from study.plan import Plan, make_plan, session_seed
from study.protocol import Protocol
from study.record import COMMON, create
from study.session import rows_of_plan, run
from study.sidecar import sidecar_of
from study.stage import Nowhere
from study.tasks import TASKS

WORTH_A_PROCESS = 20


def plan_of(protocol: Protocol, references: dict[str, int], seed: int, participant: int) -> Plan:
    """The plan of the n-th simulated participant."""
    return make_plan(protocol, references, session_seed(seed, participant))


def rows(plan: Plan) -> Iterator[dict[str, Any]]:
    """The rows of one simulated session, in memory."""
    for _, row in rows_of_plan(plan, _nowhere(plan), simulated(plan), lambda key: None):
        yield row


def simulate(
    protocol: Protocol,
    references: dict[str, int],
    participants: int,
    seed: int,
    data: Path,
    workers: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> list[Path]:
    """Simulate sessions into the data set `data`, on all cores; returns the records.

    Participants are named sim001 on; numbers that already have this task are passed over. The
    same seed into an empty data set gives the same bytes.
    """
    names = _free_names(data, protocol.label, participants)
    prepare(data)
    plans = [plan_of(protocol, references, seed, n) for n in range(participants)]
    jobs = [
        (protocol.document, references, p.seed, data, n) for p, n in zip(plans, names, strict=True)
    ]
    count = min(workers or os.cpu_count() or 1, 1 + participants // WORTH_A_PROCESS)
    paths = []
    if count == 1:
        for n, job in enumerate(jobs, start=1):
            paths.append(_one(job))
            if progress:
                progress(n)
    else:
        with ProcessPoolExecutor(count, mp_context=get_context("spawn")) as pool:
            for n, path in enumerate(pool.map(_one, jobs), start=1):
                paths.append(path)
                if progress:
                    progress(n)
    for name in names:
        enrol(data, name, observer="simulated")
    return paths


def _free_names(data: Path, label: str, count: int) -> list[str]:
    names: list[str] = []
    number = 1
    while len(names) < count:
        if number > 999_999:
            raise InputError(f"{data}: too many simulated participants; use another directory")
        name = f"sim{number:03d}"
        if not runs(data, name, label):
            names.append(name)
        number += 1
    return names


def _one(job: tuple[Any, dict[str, int], int, Path, str]) -> Path:
    """One session into its record; runs in a worker process."""
    from study.protocol import from_document

    document, references, seed, data, name = job
    protocol = from_document(document)
    plan = make_plan(protocol, references, seed)
    stage = _nowhere(plan)
    task = TASKS[protocol.file.task]
    path = record_path(data, name, protocol.label, 1)
    sidecar = sidecar_of(plan, task, observer="simulated", display=stage.display())
    record = create(path, (*COMMON, *task.columns), sidecar)
    run(plan, stage, record, simulated(plan), lambda key: None)
    return path


def _nowhere(plan: Plan) -> Nowhere:
    file = plan.protocol.file
    seconds = file.rehearsal.seconds if plan.rehearsal else file.stimuli.seconds
    return Nowhere(clip_seconds=seconds, gap=file.presentation.gap)
