"""`segue fit`: a psychometric function fitted to a table."""

import argparse
from pathlib import Path

_FUNCTIONS = ("logistic", "cumulative-normal", "weibull", "gumbel")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "table",
        metavar="TABLE.csv",
        type=Path,
        help="columns level,correct,total or level,correct (commas, semicolons or tabs)",
    )
    parser.add_argument(
        "--function", choices=_FUNCTIONS, default="logistic", help="default logistic"
    )
    parser.add_argument("--guess", type=float, default=0.5, help="guess rate (default 0.5)")
    parser.add_argument("--lapse", default="free", help="`free` (default) or a rate")
    parser.add_argument(
        "--lapse-bound",
        type=float,
        default=0.2,
        metavar="RATE",
        help="a free lapse rate stays below this (default 0.2)",
    )
    parser.add_argument(
        "--columns", metavar="NAME=OWN,…", help="the table's names, as in level=stim,correct=acc"
    )
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
    from analysis.psychometric.table import (
        check_at,
        check_samples,
        columns_of,
        lapse_of,
        read_counts,
    )
    from study.cli.common import print_json

    what = setting(args.function, args.guess, lapse_of(args.lapse), args.lapse_bound)
    at = args.at if args.d_prime is None else proportion_of(args.d_prime)
    check_at(at, what)
    summary = summarise(
        read_counts(args.table, columns_of(args.columns)),
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
    digits = _digits([told["threshold"][key] for key in ("value", "low", "high")])
    for name, value in told.items():
        if isinstance(value, dict):
            reasons = {
                key.removesuffix("_reason"): str(held).partition(",")[0]
                for key, held in value.items()
                if key.endswith("_reason")
            }
            parts = {key: held for key, held in value.items() if not key.endswith("_reason")}
            value = ", ".join(
                f"{key} {_plain(held, digits)}" for key, held in (parts | reasons).items()
            )
        places = digits if name == "location" else 6
        print(f"{name.replace('_', ' '):16} {_plain(value, places)}")
    return 0


def _digits(values: list[float | None]) -> int:
    """Significant digits that tell a threshold and its ends apart, wherever levels begin."""
    from math import ceil, log10

    known = [value for value in values if value is not None]
    largest = max(map(abs, known), default=0.0)
    spread = max(known, default=0.0) - min(known, default=0.0)
    if not largest:
        return 6
    if not spread:
        return max(6, min(ceil(log10(largest)) + 3, 15))
    return min(max(6, ceil(log10(largest / spread)) + 4), 15)


def _plain(value: object, digits: int = 6) -> str:
    if value is None:
        return "none"
    return f"{value:.{digits}g}" if isinstance(value, float) else str(value)
