"""`segue simulate`: participants without a window, on all cores, into the same record."""

import argparse
from pathlib import Path

from study.cli.common import (
    SEED,
    add_crew_options,
    add_motions_option,
    check_crew,
    print_json,
    progress,
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `segue simulate`."""
    parser.add_argument("protocol", help="a protocol file, or the name of a shipped protocol")
    parser.add_argument("--participants", type=int, required=True, metavar="N")
    parser.add_argument("--seed", type=SEED, default=1, help="default: 1")
    parser.add_argument("--data", type=Path, default=Path("data"), metavar="DIR")
    parser.add_argument("--set", dest="set_name", help="the set whose motions give the lengths")
    add_crew_options(parser)
    parser.add_argument("--json", action="store_true")
    add_motions_option(parser)


def run(args: argparse.Namespace) -> int:
    """Simulate and say where the records lie."""
    from stimuli.errors import InputError
    from stimuli.motion import Library, motion_directories
    from study.protocol.sets import references
    from study.session.simulation import simulate
    from study.trials.reading import load_protocol

    if args.participants < 1:
        raise InputError(f"--participants: expected 1 or more, found {args.participants}")
    check_crew(args)
    protocol = load_protocol(args.protocol)
    lengths = references(protocol, Library(motion_directories(args.motions)), args.set_name)
    with progress(args.participants, "simulating") as step:
        paths = simulate(
            protocol, lengths, args.participants, args.seed, args.data, args.workers, step,
            args.scheduler,
        )  # fmt: skip
    if args.json:
        trials = [path.read_text(encoding="utf-8").count("\n") - 1 for path in paths]
        print_json(
            {
                "protocol": protocol.name,
                "protocol_hash": protocol.hash,
                "seed": args.seed,
                "data": str(args.data),
                "records": [
                    {"path": str(path), "trials": count}
                    for path, count in zip(paths, trials, strict=True)
                ],
            }
        )
    else:
        print(f"{len(paths)} simulated sessions of {protocol.name} in {args.data}")
        print(f"next: segue report {args.data}")
    return 0
