"""What the subcommands share: the motions option, JSON on standard output, progress bars."""

import argparse
import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any


def add_motions_option(parser: argparse.ArgumentParser) -> None:
    """`--motions DIR`, repeatable: where clips named by their stem are looked for."""
    parser.add_argument(
        "--motions",
        metavar="DIR",
        type=Path,
        action="append",
        help="directory of motion clips (repeatable; default: SEGUE_MOTIONS, else your library)",
    )


def print_json(document: Any) -> None:
    """One JSON document on standard output; NaN is refused, since JSON has none."""
    json.dump(document, sys.stdout, indent=2, ensure_ascii=False, allow_nan=False)
    print()


@contextmanager
def progress(total: int | None, label: str) -> Iterator[Callable[..., None]]:
    """Yield `step(done, total=None)`; a bar is drawn on standard error when that is a terminal."""
    from tqdm import tqdm

    with tqdm(total=total, desc=label, disable=not sys.stderr.isatty(), leave=False) as bar:

        def step(done: int, total: int | None = None) -> None:
            bar.total = total or bar.total
            bar.update(done - bar.n)

        yield step
