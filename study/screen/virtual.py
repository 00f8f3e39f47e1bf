"""A screen where there is none: Xvfb, started for the length of a block."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from stimuli.errors import InputError


@contextmanager
def virtual_screen(width: int = 1280, height: int = 800) -> Iterator[str]:
    """Start Xvfb on a free display and yield its name; DISPLAY is set inside the block."""
    if shutil.which("Xvfb") is None:
        raise InputError(
            "no screen: expected the program Xvfb for a virtual one, found none; install xvfb "
            "(Debian: apt-get install xvfb)"
        )
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", f"{width}x{height}x24", "-nolisten",
         "tcp", "-noreset", "+extension", "GLX"],
        pass_fds=(write,),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )  # fmt: skip
    os.close(write)
    before = os.environ.get("DISPLAY")
    try:
        with os.fdopen(read) as stream:
            number = stream.readline().strip()
        if not number:
            raise RuntimeError("Xvfb did not start; run it by hand to see why")
        os.environ["DISPLAY"] = f":{number}"
        yield f":{number}"
    finally:
        if before is None:
            os.environ.pop("DISPLAY", None)
        else:
            os.environ["DISPLAY"] = before
        server.terminate()
        server.wait(timeout=10)


def has_screen() -> bool:
    """Whether there should be one to open a window on; under Wayland that is Xwayland's."""
    return sys.platform in ("win32", "darwin") or bool(os.environ.get("DISPLAY"))
