"""A real Dask scheduler on this machine: a set, simulations, a certificate, and what goes wrong."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from stimuli.cluster import cluster
from stimuli.errors import InputError, MachineError
from stimuli.motion import Library, write_walker
from stimuli.sets import Appearance, Pairing, SetSpec, build
from study.cli import main

ROOT = Path(__file__).resolve().parents[1]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1",
               "PYTHONWARNINGS": "ignore"}  # fmt: skip
PROTOCOL = """
name = "spread"
task = "odd-pair"
participants = 2
[stimuli]
reference = 10
shorter = [4]
longer = [4]
motions = [{ name = "m", from = "walk", to = "run" }]
[sets.first]
walk = { clip = "generated-walker-0", frame = 0 }
run = { clip = "generated-walker-1", frame = 0 }
[staircase]
rule = "wang"
stop = { trials = 4 }
[observer]
shorter = -4
longer = 4
slope = 1.0
"""


def dask(*words: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-m", "distributed.cli.dask_" + words[0], *words[1:]],
        env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip


@pytest.fixture(scope="module")
def scheduler() -> Iterator[str]:
    """A scheduler's address, with no worker yet."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    process = dask("scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard")
    address = f"tcp://127.0.0.1:{port}"
    until(lambda: answers(port))
    yield address
    process.terminate()
    process.wait()


@pytest.fixture
def workers(scheduler: str) -> Iterator[list[subprocess.Popen[bytes]]]:
    """Two workers of one thread, each a process that is not looked after."""
    started = [
        dask("worker", scheduler, "--nthreads", "1", "--no-nanny", "--no-dashboard")
        for _ in range(2)
    ]
    until(lambda: present(scheduler) == 2)
    yield started
    for process in started:
        process.terminate()
        process.wait()
    until(lambda: present(scheduler) == 0)


def until(holds: Callable[[], bool]) -> None:
    patience = time.monotonic() + 60
    while not holds():
        assert time.monotonic() < patience
        time.sleep(0.05)


def answers(port: int) -> bool:
    with socket.socket() as line:
        return line.connect_ex(("127.0.0.1", port)) == 0


def present(scheduler: str) -> int:
    from stimuli.cluster import _answering

    return _answering(scheduler)


@pytest.fixture
def library(tmp_path: Path) -> Library:
    for seed in range(2):
        write_walker(tmp_path / "walkers", seed)
    return Library([tmp_path / "walkers"])


@pytest.fixture
def spec() -> SetSpec:
    pairing = Pairing("walk", "generated-walker-0", 12, "generated-walker-1", 20)
    return SetSpec(
        "tiny", (pairing,), "center-aligned", reference=6, shorter=(2, 4), longer=(3,),
        seconds=0.5, foot_lock=False,
        appearance=Appearance(width=96, height=72, style="mannequin", camera="fixed"),
    )  # fmt: skip


def test_a_set_of_a_cluster_is_that_of_this_machine_though_a_worker_is_killed(
    scheduler: str,
    workers: list[subprocess.Popen[bytes]],
    spec: SetSpec,
    library: Library,
    tmp_path: Path,
) -> None:
    told: list[int] = []

    def kill_one(done: int, total: int) -> None:
        told.append(done)
        if done == 1:
            workers[0].send_signal(signal.SIGKILL)

    spread = build(spec, library, tmp_path / "spread", scheduler=scheduler, progress=kill_one)
    here = build(spec, library, tmp_path / "here", workers=1)
    assert workers[0].wait() == -signal.SIGKILL
    assert told == [0, 1, 2, 3, 4]
    assert [e.frames_sha256 for e in spread.clips] == [e.frames_sha256 for e in here.clips]
    assert [e.path.read_bytes() for e in spread.clips] == [e.path.read_bytes() for e in here.clips]
    assert spread.hash == here.hash


def doubled_slowly(job: int, shared: list[int]) -> int:
    time.sleep(0.2)
    return job * shared[0]


def test_what_is_shared_is_sent_anew_where_it_died_with_the_worker_that_had_it(
    scheduler: str, workers: list[subprocess.Popen[bytes]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """As when a cluster is too busy to hand it on before a worker is lost."""
    with cluster(scheduler) as found:
        names = {
            told["pid"]: address
            for address, told in found._client.run(lambda: {"pid": os.getpid()}).items()
        }
        first = names[workers[0].pid]
        monkeypatch.setattr(
            found, "_held",
            lambda shared: found._client.scatter([shared], workers=[first], hash=False)[0],
        )  # fmt: skip
        workers[1].send_signal(signal.SIGSTOP)  # too busy to be given a copy
        results = {}
        for place, result in found.spread(doubled_slowly, range(6), [2]):
            results[place] = result
            if len(results) == 1:
                monkeypatch.undo()
                workers[0].send_signal(signal.SIGKILL)
                workers[1].send_signal(signal.SIGCONT)
    assert results == {place: 2 * place for place in range(6)}


def records(folder: Path) -> dict[str, str]:
    return {
        path.relative_to(folder).as_posix(): path.read_text() for path in folder.rglob("*_beh.tsv")
    }


def test_simulations_and_certificates_are_those_of_this_machine(
    scheduler: str,
    workers: list[subprocess.Popen[bytes]],
    library: Library,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = tmp_path / "spread.toml"
    path.write_text(PROTOCOL)
    known = ["--motions", str(library.directories[0])]

    def told(command: list[str], *options: str) -> Any:
        assert main([*command, *options, *known, "--json"]) == 0
        return json.loads(capsys.readouterr().out)

    simulating = ["simulate", str(path), "--participants", "3"]
    for name, options in (("here", []), ("spread", ["--scheduler", scheduler])):
        told(simulating, "--data", str(tmp_path / name), *options)
    assert len(records(tmp_path / "here")) == 3
    assert records(tmp_path / "here") == records(tmp_path / "spread")
    sidecars = sorted((tmp_path / "spread").rglob("*_beh.json"))
    assert all(json.loads(sidecar.read_text())["Finished"] for sidecar in sidecars)
    certifying = ["certify", str(path), "--sets", "2", "--out", str(tmp_path / "c.json")]
    one, other = (told(certifying, *more) for more in ([], ["--scheduler", scheduler]))
    assert {**one, "created": ""} == {**other, "created": ""}


def test_a_cluster_whose_workers_all_die_is_named(
    scheduler: str,
    workers: list[subprocess.Popen[bytes]],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("stimuli.cluster.PATIENCE", 1.0)
    with cluster(scheduler) as team:
        spread = team.spread(time.sleep, [0.0, 60.0, 60.0])
        assert next(spread) == (0, None)
        for process in workers:
            process.send_signal(signal.SIGKILL)
        with pytest.raises(MachineError, match=r"none left|several dead"):
            list(spread)


def test_a_scheduler_without_workers_is_refused(scheduler: str) -> None:
    with pytest.raises(InputError, match="with workers, found one without"), cluster(scheduler):
        pass


@pytest.mark.parametrize(
    ("address", "found"),
    [("tcp://127.0.0.1:1", "nobody who answers"), ("bogus://x", "scheme"), ("here", "port number")],
)
@pytest.mark.parametrize("command", ["simulate", "certify", "render"])
def test_a_scheduler_that_nobody_answers_is_a_line(
    command: str,
    address: str,
    found: str,
    library: Library,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("stimuli.cluster.PATIENCE", 0.3)
    monkeypatch.chdir(tmp_path)
    Path("spread.toml").write_text(
        PROTOCOL + '[appearance]\nwidth = 64\nstyle = "mannequin"\ncamera = "fixed"\n'
    )
    words = [command, "spread.toml", "--motions", str(library.directories[0])]
    more = {"simulate": ["--participants", "1"]}.get(command, [])
    assert main([*words, *more, "--scheduler", address]) == 2
    told = capsys.readouterr().err.strip().splitlines()
    assert len(told) <= 2
    assert f"--scheduler {address}: expected a Dask scheduler, found" in told[0]
    assert found in told[0]
    assert not list(Path().rglob("*.tsv"))
    assert not list(Path().rglob("manifest.json"))
