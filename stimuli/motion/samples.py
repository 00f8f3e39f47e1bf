"""The sample motions: captured clips that come inside a wheel of Bullet's Python package.

They are DeepMimic's motion clips (Peng et al. 2018): walk, run, punch, kick, dances, jumps, turns.
pip downloads the one wheel below, which is never installed; only the humanoid's clips are kept.
"""

import hashlib
import json
import os
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path, PurePosixPath

from stimuli.errors import InputError
from stimuli.files import write_atomic
from stimuli.motion.library import user_library

PACKAGE = "pybullet==3.2.7"
SHA256 = "438a95e9d53af5b2e9bbf7b12e1846485e58532b57580c5290dee305fa8b4a6b"
_FOLDER = "pybullet_data/data/motions/"
_LICENCE = "pybullet-3.2.7.dist-info/LICENSE.txt"
_PIP = (
    "download", "--no-deps", "--only-binary", ":all:", "--python-version", "3.9",
    "--implementation", "cp", "--platform", "manylinux2014_x86_64", "--require-hashes",
    "--disable-pip-version-check", "--no-input", "--quiet",
)  # fmt: skip
_PATIENCE = 1200  # seconds for some 100 MB


def fetch(
    directory: Path | None = None, progress: Callable[[str], None] | None = None
) -> list[Path]:
    """Bring the sample motions into `directory` (the user's library); returns the clips' paths.

    `progress` is told what is being done. Clips that are there already are written anew. OSError
    when the wheel cannot be downloaded; InputError when it is not the one that is pinned.
    """
    tell = progress or (lambda message: None)
    target = user_library() if directory is None else Path(directory)
    with tempfile.TemporaryDirectory(prefix="segue-") as temporary:
        tell("downloading the sample motions (about 100 MB, kept: 2 MB)")
        wheel = _download(Path(temporary))
        tell("unpacking")
        return _keep_clips(wheel, target)


def _download(temporary: Path) -> Path:
    """The pinned wheel, by pip, into `temporary`."""
    pin = temporary / "pin.txt"
    pin.write_text(f"{PACKAGE} --hash=sha256:{SHA256}\n", encoding="utf-8")
    command = [sys.executable, "-P", "-m", "pip", *_PIP, "-r", str(pin), "-d", str(temporary)]
    environment = os.environ | {"TMPDIR": str(temporary), "PIP_NO_CACHE_DIR": "1"}
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=_PATIENCE, env=environment, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise OSError(f"the sample motions cannot be downloaded: {error}") from error
    wheels = list(temporary.glob("*.whl"))
    if done.returncode or len(wheels) != 1:
        lines = [line for line in done.stderr.splitlines() if line.startswith("ERROR")]
        why = lines[-1] if lines else (done.stderr.strip().splitlines() or ["pip failed"])[-1]
        raise OSError(
            f"the sample motions cannot be downloaded ({PACKAGE}): {why[:300]}\n"
            "Check the network and pip's index, or use your own clips with --motions."
        )
    return wheels[0]


def _keep_clips(wheel: Path, target: Path) -> list[Path]:
    """Write the humanoid's clips of a wheel to `target`, named by their stems as JSON."""
    with wheel.open("rb") as stream:
        found = hashlib.file_digest(stream, "sha256").hexdigest()
    if found != SHA256:
        raise InputError(
            f"{wheel.name}: expected SHA-256 {SHA256}, found {found}.\n"
            "The package index served another file; nothing of it was kept."
        )
    kept = []
    with zipfile.ZipFile(wheel) as archive:
        for member in sorted(archive.namelist()):
            if not (member.startswith(_FOLDER) and member.endswith(".txt")):
                continue
            content = archive.read(member)
            if _is_humanoid(content):
                path = target / f"{PurePosixPath(member).stem}.json"
                write_atomic(path, content)
                kept.append(path)
        write_atomic(target / "SOURCE.md", _source_note(archive.read(_LICENCE).decode()))
    return kept


def _is_humanoid(content: bytes) -> bool:
    """Whether a clip has the humanoid's 44 numbers a frame (the package has a dog's, too)."""
    frames = json.loads(content).get("Frames") or [[]]
    return len(frames[0]) == 44


def _source_note(licence: str) -> str:
    return (
        f"Motion clips of DeepMimic (Peng et al. 2018) as they come with {PACKAGE}\n"
        f"({_FOLDER}, the humanoid's; byte copies, renamed from .txt).\n\n{licence}"
    )
