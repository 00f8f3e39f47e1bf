"""The import rules of the design, held by walking every module; and the list of packages."""

import ast
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("stimuli", "study", "analysis")
# From the ground up: a module imports from its own floor and those below it.
FLOORS = (
    (
        "stimuli.cluster",
        "stimuli.compiled",
        "stimuli.errors",
        "stimuli.files",
        "stimuli.interpreter",
        "stimuli.places",
        "stimuli.ties",
    ),
    ("stimuli.processes",),
    ("stimuli.motion",),
    ("stimuli.transition",),
    ("stimuli.naturalness",),
    ("stimuli.collection",),
    ("stimuli.manifold",),
    ("stimuli.graph",),
    ("stimuli.render",),
    ("stimuli.sets",),
    ("stimuli.sheet",),
    ("study.protocol",),
    ("study.trials",),
    ("study.record",),
    ("study.session",),
    ("study.screen",),
    ("study.cli",),
)
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


def test_no_task_is_named_in_words_outside_its_module() -> None:
    """Who treats tasks apart goes by what a task says of itself."""
    from study.trials.tasks import TASKS

    naming = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for path in (ROOT / "study").rglob("*.py")
        if "tasks" not in path.parts
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Constant) and node.value in TASKS
    ]
    assert not naming


def imported_modules() -> dict[str, set[str]]:
    """Each module with the modules of the three packages that it imports, anywhere in it."""
    names = {dotted(path): path for path in MODULES}
    return {name: (imported(path) & set(names)) - {name} for name, path in names.items()}


def dotted(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def floor_of(name: str) -> int | None:
    return next(
        (n for n, floor in enumerate(FLOORS) if any(within({name}, f) for f in floor)), None
    )


def test_nobody_looks_up_from_their_floor() -> None:
    upward = [
        f"{name} imports {other}"
        for name, others in imported_modules().items()
        for other in others
        if (here := floor_of(name)) is not None
        and (there := floor_of(other)) is not None
        and there > here
    ]
    assert not upward


def test_every_module_of_stimuli_and_study_has_a_floor() -> None:
    roots = {"stimuli", "study"}
    homeless = [
        name
        for name in imported_modules()
        if name.split(".")[0] in roots and name not in roots and floor_of(name) is None
    ]
    assert not homeless


def test_no_module_imports_itself_by_way_of_others() -> None:
    """What a module takes from the package that it is part of is no way out of it."""
    graph = {
        name: {other for other in others if not within({name}, other)}
        for name, others in imported_modules().items()
    }
    order = TopologicalSorter(graph)
    order.prepare()  # raises CycleError, which names the circle


def test_a_task_is_named_by_nobody_but_the_table() -> None:
    tasks = {
        name
        for name in imported_modules()
        if within({name}, "study.trials.tasks") and not name.endswith((".task", ".tasks"))
    }
    assert len(tasks) >= 2
    naming = {name for name, others in imported_modules().items() if others & tasks}
    assert naming == {"study.trials.tasks"}


# Packages that may not import one another have these words for one and the same thing.
TWINS = {"InputError", "InputWarning", "write_atomic", "decoded", "Array", "ALL", "TASK"}


def defined_in(path: Path) -> Iterator[str]:
    """What a module defines at its top: classes, functions, constants, types."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            yield node.name
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            yield from (n.id for t in targets for n in ast.walk(t) if isinstance(n, ast.Name))


def test_one_thing_has_one_name() -> None:
    """No two modules define one public name, but in grids of variants."""
    homes: dict[str, list[str]] = {}
    for path in MODULES:
        name = dotted(path)
        if within({name}, "study.cli") or within({name}, "study.trials.tasks"):
            continue  # each command has its `run`, each task its `start` and `screens`
        for defined in defined_in(path):
            if not defined.startswith("_"):
                homes.setdefault(defined, []).append(name)
    shared = {name: where for name, where in homes.items() if len(where) > 1}
    assert set(shared) <= TWINS, shared


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
