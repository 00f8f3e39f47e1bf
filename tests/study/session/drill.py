"""A session killed at every step and at random times, and gone on with: what is kept is compared.

    python -m tests.study.session.drill [RANDOM]

A step is a call of a built-in function while the session writes: opening, writing, flushing,
syncing, renaming. Children are forked from a process that has loaded all it needs.
"""

import json
import os
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from types import FrameType, SimpleNamespace
from typing import Any

import numpy as np

from study.protocol.protocol import shipped
from study.record.dataset import finished_runs, runs
from study.record.table import reopen
from study.session.lab import Request, run_session
from study.session.stage import Nowhere
from study.trials.reading import parse_protocol

SHORT = "\n[rehearsal]\ntrials = 2\n"
PROTOCOL = parse_protocol(shipped()["jnd-center"].read_text(encoding="utf-8") + SHORT)
WRITES = ("/study/record/", "/study/session/lab.py", "/stimuli/files.py")
CLIP = SimpleNamespace(hash="h", document={"hash": "h"}, path=Path(__file__), motion="locomotion")
MANIFEST: Any = SimpleNamespace(
    directory=Path(), name=PROTOCOL.name, hash="s", clips=[CLIP], clip=lambda *_, **__: CLIP,
    pairings={"locomotion": {"reference_length": 10}, "dance": {"reference_length": 10}},
    specification="center-aligned", seconds=6.0, fps=30, frames=180,
)  # fmt: skip


def session(data: Path) -> None:
    """A rehearsal with staircases, begun or gone on with."""
    request = Request("p1", data, observer="simulated", seed=7, rehearsal=True)
    run_session(request, PROTOCOL, MANIFEST, lambda record: True, lambda *_: Nowhere(1.0, 0.5))


def killed(data: Path, arm: Callable[[], None]) -> bool:
    """Run a session in a child that `arm` will have killed; whether it was, not done before."""
    child = os.fork()
    if child == 0:
        try:
            arm()
            session(data)
        finally:
            os._exit(0)
    _, status = os.waitpid(child, 0)
    return os.WIFSIGNALED(status)


def at_step(last: int) -> Callable[[], None]:
    """Dies at the call with that number of a built-in function where the session writes."""

    def arm() -> None:
        count = 0

        def watch(frame: FrameType, event: str, argument: object) -> None:
            nonlocal count
            if event == "c_call" and any(part in frame.f_code.co_filename for part in WRITES):
                count += 1
                if count >= last:
                    os.kill(os.getpid(), signal.SIGKILL)

        sys.setprofile(watch)

    return arm


def after(seconds: float) -> Callable[[], None]:
    """Dies after a time."""

    def arm() -> None:
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_REAL, seconds)

    return arm


def kept(data: Path) -> tuple[list[dict[str, str]], dict[str, Any]]:
    """The rows of the last run but for their onsets, and how its staircases ended."""
    held = runs(data, "p1", PROTOCOL.label)
    record = reopen(held[max(held)])
    rows = [{k: v for k, v in row.items() if k != "onset"} for row in record.rows()]
    return rows, record.sidecar.get("Tracks", {})


def fault(data: Path, whole: tuple[list[dict[str, str]], dict[str, Any]]) -> str:
    """What is wrong after a kill: rows that are no beginning of the session, or another end."""
    begun = runs(data, "p1", PROTOCOL.label)
    if begun:
        rows, _ = kept(data)
        if rows != whole[0][: len(rows)]:
            return f"{len(rows)} rows are kept that the session did not have"
    if not finished_runs(data, "p1", PROTOCOL.label, rehearsal=True):
        session(data)
    if len(runs(data, "p1", PROTOCOL.label)) > 1:
        return "another run was begun"
    if kept(data) != whole:
        return "the session ended otherwise"
    left = [str(path) for path in data.rglob("*.part")]
    json.loads((data / "dataset_description.json").read_text())
    return f"half-written files are left: {left}" if len(left) > 1 else ""


def drill(random: int) -> dict[str, Any]:
    """Kill a session at every step and `random` times: how often, and what was wrong."""
    with tempfile.TemporaryDirectory(prefix="segue-") as folder:
        first = Path(folder) / "whole"
        session(first)
        start = time.perf_counter()
        session(Path(folder) / "again")
        lasts = time.perf_counter() - start
        whole = kept(first)
        told: list[str] = []
        steps = 0
        while True:
            data = Path(folder) / "step"
            if not killed(data, at_step(steps + 1)):
                break
            steps += 1
            if wrong := fault(data, whole):
                told.append(f"step {steps}: {wrong}")
            shutil.rmtree(data, ignore_errors=True)
        times, generator = 0, np.random.default_rng(1)
        while times < random:
            data, seconds = Path(folder) / "time", float(generator.uniform(0.01, 1.0) * lasts)
            if killed(data, after(seconds)):
                times += 1
            else:
                lasts *= 0.9  # the session was over before its end
            if wrong := fault(data, whole):
                told.append(f"{seconds:.4f} s: {wrong}")
            shutil.rmtree(data, ignore_errors=True)
    return {"rows": len(whole[0]), "steps": steps, "times": times, "faults": told}


if __name__ == "__main__":
    print(json.dumps(drill(int(sys.argv[1]) if len(sys.argv) > 1 else 200)))
