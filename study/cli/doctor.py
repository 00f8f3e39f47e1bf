"""`segue doctor`: what this machine can do, each line ok or what to install."""

import argparse
import json
import subprocess
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

from study.cli.common import add_motions_option, print_json

DRAWS = """
import os; os.environ["PYOPENGL_PLATFORM"] = "egl"
from stimuli.render.appearance import Appearance
from stimuli.render.scene import Renderer
renderer = Renderer(Appearance(width=64, height=64))
from stimuli.render.context import device_kinds
from stimuli.render.device import listed
told = f"{renderer.driver}; --device {listed(device_kinds())}"
renderer.close()
print(told)
"""
OPENS = """
import json
from study.protocol.schema import Keys
from study.screen.clips import Held
from study.screen.window import Look, WindowStage
look = Look(Keys(), 0.0, 0.5, 30.0, (128, 128, 128), simulated=True, pace=20.0)
stage = WindowStage(look, Held({}), None, windowed=True)
stage.tell("Segue")
print(json.dumps(stage.display()))
stage.close()
"""
_SECONDS = 60


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `segue doctor`."""
    parser.add_argument("--json", action="store_true")
    add_motions_option(parser)


def run(args: argparse.Namespace) -> int:
    """Check each part in turn; 1 when one is not ok."""
    checks: dict[str, Callable[[], str]] = {
        "rendering": _rendering,
        "window": _window,
        "keyboard": _keyboard,
        "places": _places,
        "codecs": _codecs,
        "motions": lambda: _motions(args.motions),
    }
    lines: list[dict[str, Any]] = []
    for name, check in checks.items():
        try:
            lines.append({"check": name, "ok": True, "found": check()})
        except Exception as error:
            lines.append({"check": name, "ok": False, "found": str(error)})
        if not args.json:
            state = "ok" if lines[-1]["ok"] else "NOT OK"
            print(f"{name:10} {state:7} {lines[-1]['found']}", flush=True)
    if args.json:
        print_json(lines)
    return 0 if all(line["ok"] for line in lines) else 1


def _python(script: str, remedy: str = "") -> str:
    """The last line that a script prints in a process of its own.

    Without a remedy the script's error is one of Segue's, whose second line says what to do.
    """
    from stimuli.interpreter import own_environment, own_python

    done = subprocess.run(
        own_python("-c", script),
        capture_output=True,
        text=True,
        timeout=_SECONDS,
        env=own_environment(),
        check=False,
    )
    lines = (done.stdout if done.returncode == 0 else done.stderr).strip().splitlines()
    if done.returncode != 0:
        told = lines[-1:] if remedy else lines[-2:]
        words = [*(told or ["it stopped without a word"]), *([remedy] if remedy else [])]
        raise RuntimeError("; ".join(words).replace(";; ", "; "))
    return lines[-1]


def _rendering() -> str:
    return _python(DRAWS)


def _window() -> str:
    from study.screen.virtual import has_screen, virtual_screen

    real = has_screen()
    place: Any = nullcontext() if real else virtual_screen()
    with place:
        line = _python(OPENS, "install libglu1-mesa libjack-jackd2-0 libasound2 and a screen")
    shown = json.loads(line)
    rate = shown["refresh_rate"]
    screen = f"refresh {rate} Hz" if rate else "no refresh rate; sessions pace themselves"
    return f"{'screen' if real else 'no screen, a virtual one works'}; {screen}"


def _keyboard() -> str:
    """Which keyboard a session of this user gets; the window says that it can be opened."""
    from study.screen.priority import PERMIT, may_have_priority

    if may_have_priority():
        return "psychtoolbox (ptb), in a thread of real-time priority"
    return f"keys timed by the X server, to about a millisecond; {PERMIT}"


def _places() -> str:
    """Where a user may write what libraries and processes need."""
    from multiprocessing import get_context

    from study.screen.home import has_home

    lacks = []
    if not has_home():
        lacks.append("the home folder cannot be written: compiled code and settings are made anew")
    try:
        get_context("spawn").Lock()
    except (OSError, ImportError):
        lacks.append("/dev/shm cannot be written: simulations use one core")
    return "; ".join(lacks) or "home folder and shared memory can be written"


def _codecs() -> str:
    import av

    for name in ("qtrle", "ffv1", "libx264"):
        try:
            av.CodecContext.create(name, "w")
        except Exception as error:
            raise RuntimeError(f"codec {name} is missing ({error}); reinstall av") from error
    return f"qtrle, ffv1 and h264 through PyAV {av.__version__}"


def _motions(option: list[Path] | None) -> str:
    from stimuli.motion import Library, motion_directories

    directories = [d for d in motion_directories(option) if d.is_dir()]
    count = len(Library(directories).paths())
    if not count:
        raise RuntimeError("none found; fetch the sample motions with `segue motions fetch`")
    return f"{count} clips in {', '.join(map(str, directories))}"
