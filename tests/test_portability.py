"""What sessions, fits and reports may not need, so that Windows and macOS can run them."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

from stimuli.errors import InputError
from study.protocol.protocol import shipped
from study.trials.reading import parse_protocol

ROOT = Path(__file__).resolve().parents[1]
POSIX_ONLY = ("fcntl", "termios", "pwd", "grp", "resource", "pty", "tty", "syslog", "Xlib")
LINUX_ONLY = {"study.screen.virtual"}  # nobody else starts a virtual screen
IMPORT_ALL = """
import importlib, os, sys
class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {posix}:
            raise ModuleNotFoundError(name)
for name in {posix}:
    sys.modules.pop(name, None)
sys.meta_path.insert(0, Absent())
for name in ("fork", "sched_setscheduler", "sched_param", "SCHED_FIFO", "getuid", "geteuid"):
    delattr(os, name)
for name in {modules}:
    importlib.import_module(name)
print("all")
"""


def modules() -> list[str]:
    found = []
    for package in ("study", "analysis"):
        for path in sorted((ROOT / package).rglob("*.py")):
            parts = path.relative_to(ROOT).with_suffix("").parts
            found.append(".".join(parts[:-1] if parts[-1] == "__init__" else parts))
    return [name for name in found if name not in LINUX_ONLY and not name.endswith("__main__")]


def test_every_module_is_imported_without_what_only_posix_has() -> None:
    script = IMPORT_ALL.format(posix=POSIX_ONLY, modules=modules())
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True)
    assert done.stdout == "all\n", done.stderr


def calls() -> list[tuple[str, str, list[str]]]:
    """Every call of an attribute in the packages: place, what is called, positional arguments."""
    return [
        (f"{path.relative_to(ROOT)}:{node.lineno}", ast.unparse(node.func),
         [ast.unparse(argument) for argument in node.args])
        for package in ("study", "analysis", "stimuli")
        for path in (ROOT / package).rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)
    ]  # fmt: skip


def test_files_are_put_in_place_by_replace_alone() -> None:
    """Windows renames nothing over a file that is there."""
    wrong = [(at, name) for at, name, given in calls() if name.endswith(".rename") and given]
    assert not wrong


def test_no_folder_is_opened_to_be_synced() -> None:
    opened = [(at, given) for at, name, given in calls() if name == "os.open"]
    assert all(given[0] == "os.devnull" for _, given in opened), opened
    synced = [given for _, name, given in calls() if name == "os.fsync"]
    assert len(synced) >= 3
    assert all(given[0].endswith(".fileno()") for given in synced), synced


@pytest.mark.parametrize("name", ["nul", "CON", "com1", "aux.x", "a."])
def test_no_name_of_a_protocol_is_one_that_windows_refuses(name: str) -> None:
    text = shipped()["study-one"].read_text(encoding="utf-8")
    with pytest.raises(InputError, match="Windows"):
        parse_protocol(text.replace('name = "study-one"', f'name = "{name}"'))


POSSESSIVE = re.compile(r"[*+?}]\+|\(\?>")
LIKE_A_PATTERN = re.compile(r"\\[dsSwW]|\(\?|\]\+")


def possessive(text: str | bytes) -> bool:
    """Whether a text is a pattern with a quantifier that gives nothing back."""
    plain = text if isinstance(text, str) else text.decode("latin-1")
    bare = plain.replace("\\+", "")  # a plus sign of its own
    return bool(LIKE_A_PATTERN.search(bare) and POSSESSIVE.search(bare))


def test_no_pattern_is_possessive() -> None:
    """Python 3.11.2, which Debian 12 has, matches possessive groups that failed half-way."""
    assert possessive(r"(?:e\d++)?+")
    assert possessive(rb"Frames\s*+")
    assert not possessive(r"[+-]?\d+(?:e[+-]?\d+)?|C\+\+")
    found = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for package in ("study", "analysis", "stimuli")
        for path in (ROOT / package).rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Constant) and isinstance(node.value, str | bytes)
        if possessive(node.value)
    ]
    assert not found
