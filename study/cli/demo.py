"""`segue demo`: the main job whole, from captured motion to a statistical report."""

import argparse
import subprocess
import sys
import time
from contextlib import nullcontext
from pathlib import Path
from typing import Any

from study.cli.common import SEED, add_motions_option, progress

PROTOCOL, PREFERENCE = "jnd-center", "study-one"
_PEOPLE = 12


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `segue demo`."""
    parser.add_argument("--out", type=Path, default=Path("demo"), metavar="DIR")
    parser.add_argument("--seed", type=SEED, default=2005, metavar="N")
    add_motions_option(parser)


def run(args: argparse.Namespace) -> int:
    """Motions, stimuli, a rehearsal in the window, twelve simulated people, the report."""
    began = time.monotonic()
    out = args.out.resolve()
    directories = _motions(args.motions, out)
    _say(f"motions: {', '.join(str(d) for d in directories)}")
    stimuli = _stimuli(directories, out)
    _say(f"stimuli: {stimuli}")
    data = out / "data"
    participant = _free_participant(data)
    _rehearse(stimuli, directories, data, participant, args.seed)
    _say(f"rehearsal in the window: sub-{participant}")
    _simulate(directories, data, args.seed)
    _say(f"{_PEOPLE} people simulated")
    report = _report(data)
    _say(f"done in {time.monotonic() - began:.0f} s")
    print(f"report: {report}")
    return 0


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def _motions(option: list[Path] | None, out: Path) -> list[Path]:
    """Directories that hold a set of the demo's protocol: what is there, fetched, or generated."""
    from stimuli.errors import InputError
    from stimuli.motion import Library, fetch, motion_directories, user_library, write_walker
    from study.protocol.sets import choose_set
    from study.trials.reading import load_protocol

    protocols = [load_protocol(PROTOCOL), load_protocol(PREFERENCE)]
    directories = motion_directories(option)

    def complete(candidates: list[Path]) -> bool:
        try:
            library = Library([d for d in candidates if d.is_dir()])
            return all(choose_set(p, library) for p in protocols)
        except InputError:
            return False

    if complete(directories):
        return directories
    try:
        _say("fetching the sample motions (about 100 MB, once) …")
        fetch(user_library())
        return [*directories, user_library()]
    except (InputError, OSError) as error:
        _say(f"the sample motions cannot be fetched: {error}")
        _say("going on with a GENERATED walker: synthetic motion, fit for a trial run only")
    generated = out / "generated-motions"
    for seed in range(3):
        write_walker(generated, seed)
    return [*directories, generated]


def _stimuli(directories: list[Path], out: Path) -> Path:
    from stimuli.motion import Library
    from stimuli.sets import build
    from study.protocol.sets import set_spec
    from study.trials.reading import load_protocol

    library = Library([d for d in directories if d.is_dir()])
    spec = set_spec(load_protocol(PROTOCOL), None, library, rehearsal=True)
    folder = out / "stimuli" / f"{PROTOCOL}-rehearsal"
    with progress(None, "rendering") as step:
        build(spec, library, folder, progress=step)
    return folder


def _free_participant(data: Path) -> str:
    from study.record.dataset import runs
    from study.trials.reading import load_protocol

    label = load_protocol(PROTOCOL).label
    return next(n for k in range(1, 10_000) if not runs(data, n := f"rehearsal{k}", label))


def _rehearse(
    stimuli: Path, directories: list[Path], data: Path, participant: str, seed: int
) -> None:
    """A session in PsychoPy's window, in a process of its own, on a virtual screen if need be."""
    from stimuli.interpreter import own_environment, own_python
    from study.screen.virtual import has_screen, virtual_screen

    command = own_python(
        "-m", "study.cli", "run", PROTOCOL, "--rehearsal", "--windowed",
        "--participant", participant, "--observer", "simulated", "--data", str(data),
        "--stimuli", str(stimuli), "--seed", str(seed),
    )  # fmt: skip
    place: Any = nullcontext() if has_screen() else virtual_screen()
    with place:
        done = subprocess.run(
            command, env=own_environment(), capture_output=True, text=True, check=False
        )
    for line in done.stderr.splitlines():
        if not line.startswith("Xlib:"):  # the X library's own chatter about a virtual screen
            _say(line)
    if done.returncode != 0:
        raise RuntimeError(f"the rehearsal stopped with exit code {done.returncode}")


def _simulate(directories: list[Path], data: Path, seed: int) -> None:
    from stimuli.motion import Library
    from study.protocol.sets import references
    from study.session.simulation import simulate
    from study.trials.reading import load_protocol

    library = Library([d for d in directories if d.is_dir()])
    for name in (PROTOCOL, PREFERENCE):
        protocol = load_protocol(name)
        with progress(_PEOPLE, f"simulating {name}") as step:
            simulate(protocol, references(protocol, library), _PEOPLE, seed, data, progress=step)


def _report(data: Path) -> Path:
    from analysis.report import write_report

    return write_report([data]).page
