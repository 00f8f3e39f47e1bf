"""`segue fit`: a psychometric function fitted to a table."""

import argparse
from pathlib import Path

FUNCTIONS = ("logistic", "cumulative-normal", "weibull", "gumbel")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "table",
        metavar="TABLE.csv",
        type=Path,
        help="columns level,correct,total or level,correct (commas, semicolons or tabs)",
    )
    parser.add_argument(
        "--function", choices=FUNCTIONS, default="logistic", help="default logistic"
    )
    parser.add_argument("--guess", type=float, default=0.5, help="guess rate (default 0.5)")
    parser.add_argument("--lapse", default="free", help="`free` (default) or a rate")
    parser.add_argument("--at", type=float, default=0.75, help="proportion (default 0.75)")
    parser.add_argument(
        "--d-prime",
        type=float,
        metavar="D",
        help="give the threshold at this d′ of two-alternative forced choice instead of --at",
    )
    parser.add_argument(
        "--bootstrap",
        metavar="N",
        type=int,
        help="interval from N parametric bootstrap samples instead of the profile likelihood",
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of the resampling (default 0)")
    parser.add_argument("--json", action="store_true", help="print the fit as JSON")


def run(args: argparse.Namespace) -> int:
    import numpy as np

    from analysis.psychometric import setting, summarise
    from analysis.psychometric.dprime import proportion_of
    from analysis.psychometric.table import check_at, check_samples, lapse_of, read_counts
    from study.cli.common import print_json

    what = setting(args.function, args.guess, lapse_of(args.lapse))
    at = args.at if args.d_prime is None else proportion_of(args.d_prime)
    check_at(at, what)
    summary = summarise(
        read_counts(args.table),
        what,
        (at,),
        interval="parametric" if args.bootstrap else "profile",
        samples=check_samples(args.bootstrap),
        rng=np.random.default_rng(args.seed),
    )
    told = summary.as_dict()
    if args.json:
        print_json(told)
        return 0
    for name, value in told.items():
        if isinstance(value, dict):
            value = ", ".join(f"{key} {_plain(held)}" for key, held in value.items())
        print(f"{name.replace('_', ' '):16} {_plain(value)}")
    return 0


def _plain(value: object) -> str:
    if value is None:
        return "none"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
