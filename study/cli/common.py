"""What the subcommands share: options and their checks, JSON on standard output, progress bars."""

import argparse
import json
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stimuli.motion import Motion

HIGHEST = 1e6  # of the velocity weight
SPECIFICATION_NAMES = ("start-end", "center-aligned")  # `--help` is to load nothing heavy


def argument(kind: type, expected: str, fits: Callable[[Any], bool]) -> Callable[[str], Any]:
    """An argparse type: text read by `kind` that `fits`, else bad usage that says `expected`."""

    def parse(text: str) -> Any:
        try:
            value = kind(text)
        except ValueError:
            value = None
        if value is None or not fits(value):
            raise argparse.ArgumentTypeError(f"expected {expected}, found {text}")
        return value

    return parse


_FRAMES = argument(int, "a number of frames, 0 or more", lambda n: n >= 0)
SEED = argument(int, "a whole number, 0 or more", lambda n: n >= 0)
COUNT = argument(int, "a whole number, 1 or more", lambda n: n >= 1)
VELOCITY = argument(float, f"a number from 0 to {HIGHEST:g}", lambda x: 0 <= x <= HIGHEST)
TAU = argument(float, "a number above 0", lambda x: 0 < x < float("inf"))
SIGMA = argument(float, "a finite number above 0", lambda x: 0 < x < float("inf"))


def add_motions_option(parser: argparse.ArgumentParser) -> None:
    """`--motions DIR`, repeatable: where clips named by their stem are looked for."""
    parser.add_argument(
        "--motions",
        metavar="DIR",
        type=Path,
        action="append",
        help="directory of motion clips (repeatable; default: SEGUE_MOTIONS, else your library)",
    )


def add_crew_options(parser: argparse.ArgumentParser) -> None:
    """`--workers N` and `--scheduler ADDRESS`: who does the work."""
    parser.add_argument("--workers", type=int, metavar="N", help="processes (default: all cores)")
    parser.add_argument(
        "--scheduler", metavar="ADDRESS", help="of a Dask cluster that does the work instead"
    )


def check_crew(args: argparse.Namespace) -> None:
    """InputError unless `--workers` and `--scheduler` can be meant."""
    from stimuli.errors import InputError

    if args.workers is not None and args.workers < 1:
        raise InputError(f"--workers: expected 1 or more, found {args.workers}")
    if args.workers is not None and args.scheduler is not None:
        raise InputError(
            "--workers, --scheduler: expected one of them, found both; a cluster has its own."
        )


def add_velocity_option(parser: argparse.ArgumentParser) -> None:
    """`--velocity-weight NU`: how much differing velocities count."""
    parser.add_argument(
        "--velocity-weight", type=VELOCITY, default=1.0, metavar="NU",
        help="ν, by which differing velocities count (default 1)",
    )  # fmt: skip


def add_specification_option(parser: argparse.ArgumentParser) -> None:
    """`--specification`: what the two frames of a transition are."""
    first, other = SPECIFICATION_NAMES
    parser.add_argument(
        "--specification", default=first, help=f"{first} or {other} (default {first})"
    )


def explain_points(parser: argparse.ArgumentParser) -> None:
    """What A:i and B:j mean, below the options."""
    parser.epilog = (
        "A:i B:j: in start-end the blend begins at frame i of A and ends at frame j of B; in "
        "center-aligned both meet in its middle. Frames are 0-based, at 30 a second."
    )


def add_room_options(parser: argparse.ArgumentParser) -> None:
    """`--before N` and `--after N`: frames that a transition point must have around it."""
    for side in ("before", "after"):
        parser.add_argument(
            f"--{side}",
            type=_FRAMES,
            default=0,
            metavar="N",
            help=f"frames wanted {side} the transition (default 0)",
        )


def check_room(
    args: argparse.Namespace, froms: "Sequence[Motion]", tos: "Sequence[Motion]"
) -> None:
    """InputError where no frames of these motions have the room that the options want."""
    from stimuli.errors import InputError

    before, after = max(map(len, froms)) - 1, max(map(len, tos)) - 1
    if args.before > before or args.after > after:
        raise InputError(
            f"--before {args.before} --after {args.after}: no transition point has that room; "
            f"expected at most {before} frames before it and {after} after it in these clips."
        )


def check_outputs(*outputs: tuple[str, Path | None, Sequence[str]]) -> None:
    """InputError unless every file wanted can be written; called before any work.

    An output is its option, its path (None when it is not wanted) and the suffixes it may have.
    """
    from stimuli.errors import InputError
    from stimuli.files import check_writable

    for option, path, suffixes in outputs:
        if path is None:
            continue
        if path.suffix.lower() not in suffixes:
            kinds = " or ".join(suffixes)
            raise InputError(f"{option}: expected a file name with {kinds}, found {path}.")
        check_writable(path)


def print_json(document: Any) -> None:
    """One JSON document on standard output; NaN is refused, since JSON has none.

    The document is whole before anything is printed.
    """
    print(json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False))


@contextmanager
def progress(total: int | None, label: str) -> Iterator[Callable[..., None]]:
    """Yield `step(done, total=None)`; a bar is drawn on standard error when that is a terminal."""
    from shutil import get_terminal_size

    from tqdm import tqdm

    shown = sys.stderr.isatty()
    wide, high = get_terminal_size()  # 80 by 24 where a terminal says 0, where tqdm draws nothing
    with tqdm(
        total=total, desc=label, disable=not shown, leave=False, ncols=wide, nrows=high
    ) as bar:

        def step(done: int, total: int | None = None) -> None:
            bar.total = total or bar.total
            bar.update(done - bar.n)

        yield step
