"""`segue anonymise`: a copy of a data set with new ids, without free text and times of day."""

import argparse
import sys
from pathlib import Path

from study.cli.common import SEED


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `segue anonymise`."""
    parser.add_argument("data", metavar="DATA", type=Path, help="data set, left as it is")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="must not exist yet")
    parser.add_argument(
        "--seed", type=SEED, metavar="N",
        help="of the ids, by which you can tell people again; keep it to yourself "
        "(default: drawn, and nobody can)",
    )  # fmt: skip


def run(args: argparse.Namespace) -> int:
    """Copy, and say what was left out."""
    import secrets

    import numpy as np

    from study.record.anonymise import anonymise

    seed = secrets.randbits(128) if args.seed is None else args.seed
    made = anonymise(args.data, args.out, np.random.default_rng(seed))
    for told in made.left_out:
        print(f"left out: {told}", file=sys.stderr)
    people = "1 person" if made.people == 1 else f"{made.people} people"
    print(f"{people} under new ids in {made.folder}")
    return 0
