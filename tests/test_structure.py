"""The import rules of the design, held by walking every module; and the list of packages."""

import ast
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("stimuli", "study", "analysis")
MODULES = sorted(p for name in PACKAGES for p in (ROOT / name).rglob("*.py"))


def imported(path: Path) -> set[str]:
    """The dotted names of all modules that a file imports, anywhere in it."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return names


def within(names: set[str], package: str) -> set[str]:
    return {name for name in names if name == package or name.startswith(package + ".")}


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(ROOT)))
def test_imports_flow_one_way(path: Path) -> None:
    names = imported(path)
    parts = path.relative_to(ROOT).parts
    if parts[:2] == ("study", "cli"):
        return
    forbidden: set[str] = set()
    if parts[0] in ("stimuli", "analysis"):
        for other in set(PACKAGES) - {parts[0]}:
            forbidden |= within(names, other)
    if parts[0] == "study":
        forbidden |= within(names, "analysis") - within(names, "analysis.psychometric")
    if parts[:2] != ("study", "screen"):
        forbidden |= within(names, "psychopy")
    if parts[:2] != ("stimuli", "render"):
        forbidden |= within(names, "pyrender") | within(names, "OpenGL")
    assert not forbidden


def test_the_psychometric_functions_need_numpy_and_scipy_only() -> None:
    script = (
        "import sys, analysis.psychometric;"
        "print([m for m in ('pandas', 'statsmodels', 'matplotlib') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd=ROOT)
    assert done.stdout.strip() == "[]", done.stderr


def test_help_loads_nothing_heavy() -> None:
    script = (
        "import sys\n"
        "from study.cli import main\n"
        "try: main(['--help'])\n"
        "except SystemExit: pass\n"
        "heavy = ('numpy', 'pydantic', 'psychopy', 'pandas', 'scipy', 'pyrender')\n"
        "print([m for m in heavy if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd=ROOT)
    assert done.stdout.strip().endswith("[]"), done.stdout + done.stderr


def test_every_package_is_listed_by_hand() -> None:
    listed = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"]
    there = {
        ".".join(path.parent.relative_to(ROOT).parts)
        for name in (*PACKAGES, "protocols")
        for path in (ROOT / name).rglob("__init__.py")
    }
    assert set(listed) == there
