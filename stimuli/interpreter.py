"""Python processes of ours: they find these packages, and none of the files that lie about.

Without `-P` Python looks for modules in the folder where a command was typed: a script `six.py` or
`queue.py` of somebody there would be taken for the library of that name.
"""

import os
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def own_python(*words: str) -> list[str]:
    """The command of a Python process with these words."""
    return [sys.executable, "-P", *words]


def own_environment() -> dict[str, str]:
    """This process's environment, in which Python finds these packages first."""
    held = os.environ.get("PYTHONPATH")
    return {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *([held] if held else [])])}
