"""`segue report`: session records in, a statistical report out."""

import argparse
import sys
from pathlib import Path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("data", metavar="DATA", type=Path, nargs="+", help="data set or table")
    parser.add_argument(
        "--out", metavar="DIR", type=Path, help="default: DATA/derivatives/segue of the first DATA"
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of the resampling (default 0)")
    parser.add_argument(
        "--second-opinion",
        action="store_true",
        help="add psignifit's thresholds, where it is installed",
    )
    parser.add_argument(
        "--columns",
        metavar="NAME=OWN,…",
        help="the tables' own names for columns, as in participant=subj,level=stim,correct=acc",
    )
    parser.add_argument("--json", action="store_true", help="print report.json's document")


def run(args: argparse.Namespace) -> int:
    from analysis.errors import NothingAnalysed
    from analysis.psychometric.table import columns_of
    from analysis.report import write_report

    columns = columns_of(args.columns)
    try:
        written = write_report(args.data, args.out, args.seed, args.second_opinion, columns)
    except NothingAnalysed as nothing:  # the input is sound, but there is no report of it
        if args.debug:
            raise
        print(f"segue report: {nothing}", file=sys.stderr)
        return 1
    for note in written.document["unread"]:
        print(f"segue report: not read: {note}", file=sys.stderr)
    for remark in (r for study in written.document["studies"] for r in study["remarks"]):
        print(f"segue report: warning: {remark}", file=sys.stderr)
    if args.json:
        from analysis.report.write import clean
        from study.cli.common import print_json

        print_json(clean(written.document))
    else:
        print(written.page)
    return 0
