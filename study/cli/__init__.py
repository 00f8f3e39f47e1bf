"""The command line: a table of subcommands, each imported only when it is called."""

import argparse
import atexit
import importlib
import importlib.util
import os
import sys
import tempfile
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

COMMANDS = {
    "demo": "do the main job on sample motions: stimuli, a session, a report",
    "doctor": "say what this machine can do, and what to install",
    "motions": "list motion clips, or fetch the sample motions",
    "cost": "the cost of a transition between every two frames",
    "length": "how long a blend should last",
    "blend": "join two motions and write the result",
    "graph": "motion graphs: build, show, search for demands, shortest path",
    "embed": "poses in few dimensions, and motion decoded from them",
    "score": "how natural motions are, by feet, balance and flight",
    "weights": "weights of the pose cost from labelled transitions",
    "render": "build or complete a protocol's stimulus set",
    "certify": "what a protocol will be able to show, before any session",
    "run": "run one session",
    "simulate": "simulate participants without a window",
    "fit": "fit a psychometric function to a table",
    "report": "turn session records into a statistical report",
    "anonymise": "copy a data set with new ids, without free text and times of day",
    "export": "pack a study for a repository, as Psych-DS or as an RO-Crate",
}


_STATISTICS = ("certify", "simulate", "fit", "report", "demo")


def main(argv: Sequence[str] | None = None) -> int:
    """Run one subcommand; returns the exit code (0 done, 1 failed, 2 bad usage or input)."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    if fault := _intruder():
        print(fault, file=sys.stderr)
        return 2
    named = next((word for word in arguments if not word.startswith("-")), None)
    args = _parser(named).parse_args(arguments)
    if named in _STATISTICS:
        # Their problems are small: threads cost ten times what they save. Set before NumPy loads.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    warnings.showwarning = _say_warning
    _spare_matplotlib()
    try:
        return _run(args)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 1
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except Exception as error:
        if args.debug:
            raise
        print(f"segue {named}: {_message(error)}", file=sys.stderr)
        return 2 if _is_input_fault(error) else 1


def _run(args: argparse.Namespace) -> int:
    """Run a command; where it is given a battery, for each of its protocols."""
    if "protocol" in args:
        from study.protocol.battery import battery_of

        if (battery := battery_of(args.protocol)) is not None:
            from study.cli.battery import run_each

            return run_each(battery, args)
    return int(args.run(args))


class _Parser(argparse.ArgumentParser):
    """A parser that says bad usage in a line, as other faults are said, without the usage."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message} (`{self.prog} --help` tells more)\n")


def _say_warning(message: Warning | str, *_: object, **__: object) -> None:
    """A warning as a line for people, without the place in the code that raised it."""
    print(f"segue: warning: {message}", file=sys.stderr)


def _parser(named: str | None) -> argparse.ArgumentParser:
    """The whole parser; only the command that is `named` gets its own arguments."""
    parser = _Parser(
        prog="segue", description="How do people see the transitions between captured motions?"
    )
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name in available():
        sub = commands.add_parser(name, help=COMMANDS[name], description=COMMANDS[name])
        sub.add_argument("--debug", action="store_true", help="show a traceback on errors")
        if name == named:
            module = importlib.import_module(f"study.cli.{name}")
            module.add_arguments(sub)
            sub.set_defaults(run=module.run)
    return parser


def available() -> list[str]:
    """The commands whose modules are there."""
    here = Path(__file__).parent
    return [name for name in COMMANDS if (here / f"{name}.py").exists()]


def _spare_matplotlib() -> None:
    """Without a home folder to write, matplotlib says so at length at every start."""
    if "MPLCONFIGDIR" not in os.environ and not os.access(Path("~").expanduser(), os.W_OK):
        made = tempfile.TemporaryDirectory(prefix="segue-matplotlib-")
        atexit.register(made.cleanup)
        os.environ["MPLCONFIGDIR"] = made.name


def _intruder() -> str | None:
    """A message when `stimuli` or `analysis` is not the package beside this one."""
    beside = Path(__file__).resolve().parents[2]
    for name in ("stimuli", "analysis"):
        spec = importlib.util.find_spec(name)
        origin = Path(spec.origin).resolve() if spec and spec.origin else None
        if origin is None or origin.parents[1] != beside:
            return (
                f"segue: expected the package {name} in {beside}, found {origin or 'none'}.\n"
                "Install Segue in an environment of its own, or take that path off PYTHONPATH."
            )
    return None


def _message(error: Exception) -> str:
    text = str(error) or type(error).__name__
    told = _is_input_fault(error) or _is(error, "MachineError")
    return text if told else f"{text} (--debug shows where)"


def _is_input_fault(error: Exception) -> bool:
    """InputError of `stimuli` or of `analysis`, without importing either before it is raised."""
    return _is(error, "InputError")


def _is(error: Exception, name: str) -> bool:
    return any(kind.__name__ == name for kind in type(error).__mro__)
