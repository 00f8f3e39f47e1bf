"""What is sensitive to the machine, under settings that stand for other machines and other users.

    python -m tests.portable [SETTING ...]     # make test-portable: all of them, some half an hour

Each setting is checked to have taken effect in the process that it is for. Under each, tests whose
figures go through what it changes are run; under those that change arithmetic all clips of the
shipped protocols are planned and their sessions simulated: names, lengths and trials must be the
same to the letter, poses to `POSES`. Pictures, and costs in single precision, are not compared:
their last digits are the same on one machine alone.
"""

import csv
import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
PYTEST = ("-m", "pytest", "-q", "-p", "no:cacheprovider")
POSES = 1e-9  # metres and half-angle radians between the poses of two processors
TIMES = ("onset", "response_time")  # of a trial, seconds
NOBODY = 65534  # an ordinary user whom every system has
SEEDS = 20
# Patterns of tests. Sums, products, angles and what is chosen by them: what reads, joins, names,
# dresses and frames motions, and the figures of the report; not what simulates for minutes.
NUMBERS = (
    "tests/stimuli/motion/test_[!f]*.py", "tests/stimuli/transition/test_*.py",
    "tests/stimuli/test_ties.py", "tests/stimuli/sets/test_[!br]*.py",
    "tests/stimuli/render/test_[bc]*.py", "tests/stimuli/render/test_shapes.py",
    "tests/analysis/test_[!cr]*.py", "tests/analysis/test_ra*.py",
    "tests/analysis/psychometric/test_[!c]*.py", "tests/papers/test_*.py",
    "tests/study/**/test_sets.py", "tests/study/**/test_staircase*.py",
)  # fmt: skip
# Words, dates, the order of files, what may be written where, processes beside one another.
PLACES = (
    "tests/stimuli/motion/test_[lmc]*.py", "tests/stimuli/sets/test_*.py",
    "tests/stimuli/render/test_video.py", "tests/stimuli/transition/test_draw.py",
    "tests/analysis/test_[fr]*.py", "tests/study/**/test_*.py", "tests/test_cli.py",
)  # fmt: skip
PROBE = """
import json, os, sys, time
import numpy, scipy.linalg, threadpoolctl
from numpy._core._multiarray_umath import __cpu_features__ as features
print(json.dumps({
    "blas": sorted({pool.get("architecture") for pool in threadpoolctl.threadpool_info()
                    if pool["internal_api"] == "openblas"}),
    "features": [name for name, there in features.items() if there],
    "numba": os.environ.get("NUMBA_CPU_NAME"), "zone": time.tzname, "user": os.geteuid(),
    "cores": len(os.sched_getaffinity(0)), "locale": os.environ.get("LC_ALL"),
}))
"""

Probe = Mapping[str, Any]


@dataclass(frozen=True)
class Setting:
    """Environment variables and a user, what is run under them, and whether they took effect."""

    effect: Callable[[Probe], bool]
    environment: Mapping[str, str] = field(default_factory=dict)
    tests: Sequence[str] = NUMBERS
    ordinary: bool = False  # as a user who may write nothing but a home folder
    cores: int | None = None
    seeds: int = 0  # other seeds of hypothesis; 0: the suite's own

    @property
    def arithmetic(self) -> bool:
        """Whether it changes how sums are made."""
        return self.tests is NUMBERS and not self.seeds


def kernel(name: str, *told: str) -> Setting:
    """OpenBLAS as on a processor, by the names of the kernels that its builds have for it."""
    return Setting(lambda found: set(found["blas"]) <= {name, *told}, {"OPENBLAS_CORETYPE": name})


def without(*features: str) -> Setting:
    """NumPy without some instructions of this processor."""
    return Setting(
        lambda found: not set(features) & set(found["features"]),
        {"NPY_DISABLE_CPU_FEATURES": " ".join(features)},
    )


def dispatched() -> list[str]:
    """What NumPy uses of this processor beyond what it was built for."""
    from numpy._core import _multiarray_umath as built

    return [name for name in built.__cpu_dispatch__ if built.__cpu_features__.get(name)]


SETTINGS: Mapping[str, Setting] = {
    "Prescott": kernel("Prescott", "Katmai"),
    "Nehalem": kernel("Nehalem"),
    "Haswell": kernel("Haswell"),
    "Zen": kernel("Zen", "Haswell"),
    "no AVX2, no FMA3": without("AVX2", "FMA3"),
    "no vectors": without(*dispatched()),
    "generic Numba": Setting(
        lambda found: found["numba"] == "generic", {"NUMBA_CPU_NAME": "generic"}
    ),
    "C in Kathmandu": Setting(
        lambda found: found["locale"] == "C" and found["zone"][0] == "+0545",
        {"LC_ALL": "C", "TZ": "Asia/Kathmandu"},
        PLACES,
    ),
    "ordinary user": Setting(lambda found: found["user"] != 0, tests=PLACES, ordinary=True),
    "one core": Setting(lambda found: found["cores"] == 1, tests=PLACES, cores=1),
    "other seeds": Setting(lambda found: True, seeds=SEEDS),
}


@contextmanager
def process(setting: Setting) -> Iterator[Callable[..., subprocess.CompletedProcess[str]]]:
    """A way to run Python under a setting, in a home folder of its own with the sample motions."""
    from stimuli.motion import user_library

    with tempfile.TemporaryDirectory(prefix="segue-") as folder:
        home = Path(folder)
        library = home / "share" / "segue" / "motions"
        if user_library().is_dir():
            shutil.copytree(user_library(), library)
        environment = os.environ | {
            "XDG_DATA_HOME": str(home / "share"),
            "HYPOTHESIS_STORAGE_DIRECTORY": str(home / "seen"),
            "NUMBA_CACHE_DIR": str(home / "numba"), "PYTHONDONTWRITEBYTECODE": "1",
            **setting.environment,
        }  # fmt: skip
        options: dict[str, Any] = {}
        if setting.ordinary:
            environment |= {"HOME": folder, "TMPDIR": folder, "MPLCONFIGDIR": folder}
            options["umask"] = 0o077
            if os.geteuid() == 0:
                for path in (home, *home.rglob("*")):
                    os.chown(path, NOBODY, NOBODY)
                options |= {"user": NOBODY, "group": NOBODY, "extra_groups": []}
        command = [sys.executable]
        if setting.cores:
            chosen = sorted(os.sched_getaffinity(0))[: setting.cores]
            pinned = (f"import os, sys; os.sched_setaffinity(0, {chosen}); "
                      "os.execv(sys.executable, [sys.executable, *sys.argv[1:]])")  # fmt: skip
            command += ["-c", pinned]

        def run(*words: str) -> subprocess.CompletedProcess[str]:
            return subprocess.run(
                [*command, *words], cwd=ROOT, env=environment, capture_output=True, text=True,
                check=False, **options,
            )  # fmt: skip

        yield run


def tested(name: str, usual: Mapping[str, Any]) -> str:
    """Run what a setting is for; what went wrong, or nothing."""
    setting = SETTINGS[name]
    with process(setting) as run:
        probe = run("-c", PROBE)
        if probe.returncode:
            return f"no process could be started: {probe.stderr.strip()[-600:]}"
        if not setting.effect(json.loads(probe.stdout)):
            return f"it took no effect: {probe.stdout}"
        if setting.arithmetic and (told := differing(usual, planned(run))):
            return told
        if not setting.seeds:
            return _failures(run(*PYTEST, *paths_of(setting.tests)))
        drawn = [path for path in paths_of(("tests/**/test_*.py",))
                 if "from hypothesis" in (ROOT / path).read_text(encoding="utf-8")]  # fmt: skip
        for seed in range(1, setting.seeds + 1):
            words = (f"--hypothesis-seed={seed}", "-m", "hypothesis and not slow", *drawn)
            if told := _failures(run(*PYTEST, *words)):
                return f"seed {seed}: {told}"
    return ""


def paths_of(patterns: Sequence[str]) -> list[str]:
    """The files that patterns mean, in order; ValueError for one that means none."""
    found = {pattern: sorted(ROOT.glob(pattern)) for pattern in patterns}
    if lost := [pattern for pattern, paths in found.items() if not paths]:
        raise ValueError(f"{', '.join(lost)}: expected tests, found none")
    every = (path for paths in found.values() for path in paths)
    return list(dict.fromkeys(str(path.relative_to(ROOT)) for path in every))


def _failures(done: subprocess.CompletedProcess[str]) -> str:
    return "" if done.returncode == 0 else done.stdout[-4000:] + done.stderr[-1000:]


def planned(run: Callable[..., subprocess.CompletedProcess[str]]) -> dict[str, Any]:
    """Clips and trials of the shipped protocols, in a process of `run`."""
    with tempfile.TemporaryDirectory(prefix="segue-") as folder:
        path = Path(folder) / "planned.npz"
        done = run("-m", "tests.portable", "--plan", str(path))
        if done.returncode:
            raise RuntimeError(done.stderr)
        with np.load(path) as kept:
            return dict(kept)


def plan(path: Path) -> None:
    """Write to `path` what `planned` reads."""
    from tests.stimuli.sets import recipe

    groups = [group for of_set in recipe.planned().values() for group in of_set]
    clips = [clip for group in groups for clip in group.clips]
    motions = [clip.laid_out.motion for clip in clips]
    np.savez(
        path,
        names=np.array([clip.hash for clip in clips]),
        trials=np.array(trials()),
        lengths=np.array([clip.document["length"] for clip in clips]),
        poses=np.concatenate([motion.rotations.ravel() for motion in motions]),
        roots=np.concatenate([motion.root.ravel() for motion in motions]),
    )


def trials() -> list[str]:
    """Every trial of two simulated people in each shipped protocol, without its times."""
    import protocols
    from study.cli import main as segue

    rows = []
    for path in sorted(Path(protocols.__file__).parent.glob("*.toml")):
        with tempfile.TemporaryDirectory(prefix="segue-") as folder, redirect_stdout(StringIO()):
            words = ("--participants", "2", "--seed", "5", "--data", folder, "--workers", "1")
            if segue(["simulate", str(path), *words]):
                raise RuntimeError(f"{path.name} cannot be simulated")
            for record in sorted(Path(folder).rglob("*_beh.tsv")):
                with record.open(encoding="utf-8", newline="") as stream:
                    rows += [
                        "\t".join(value for key, value in row.items() if key not in TIMES)
                        for row in csv.DictReader(stream, delimiter="\t")
                    ]
    return rows


def differing(usual: Mapping[str, Any], found: Mapping[str, Any]) -> str:
    """What tells two machines' plans apart, in words; nothing where nobody could."""
    for key in ("names", "lengths", "trials"):
        if usual[key].shape != found[key].shape:
            return f"{len(found[key])} {key}, {len(usual[key])} on another processor"
        if apart := int(np.sum(usual[key] != found[key])):
            return f"{apart} of {len(usual[key])} {key} are others"
    far = max(float(np.abs(usual[key] - found[key]).max()) for key in ("poses", "roots"))
    print(f"   {len(usual['names'])} clips of the same names, poses apart by {far:.1g}; "
          f"{len(usual['trials'])} trials the same", flush=True)  # fmt: skip
    return "" if far < POSES else f"poses differ by {far:.1g}"


def main(words: Sequence[str]) -> int:
    """Run the settings named, or all; 1 where one fails."""
    if words and words[0] == "--plan":
        plan(Path(words[1]))
        return 0
    if unknown := set(words) - set(SETTINGS):
        print(f"expected settings among {', '.join(SETTINGS)}, found {', '.join(unknown)}")
        return 2
    names = list(words or SETTINGS)
    usual: dict[str, Any] = {}
    if any(SETTINGS[name].arithmetic for name in names):
        with process(Setting(lambda found: True)) as run:
            usual = planned(run)
    failed = 0
    for name in names:
        start = time.monotonic()
        told = tested(name, usual)
        minutes = (time.monotonic() - start) / 60
        print(f"{name}: {'FAILED' if told else 'passed'} in {minutes:.1f} minutes", flush=True)
        if told:
            print(told, flush=True)
            failed += 1
    print(f"{len(names) - failed} of {len(names)} settings passed on {platform.machine()}")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
