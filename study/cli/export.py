"""`segue export`: a study packed for a repository, as Psych-DS or as an RO-Crate."""

import argparse
import sys
from pathlib import Path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `segue export`."""
    parser.add_argument("data", metavar="DATA", type=Path, help="data set, left as it is")
    parser.add_argument(
        "--psych-ds", type=Path, metavar="OUT", help="a folder of described tables (Psych-DS)"
    )
    parser.add_argument(
        "--ro-crate", type=Path, metavar="OUT", help="the data set with RO-Crate metadata"
    )


def run(args: argparse.Namespace) -> int:
    """Pack, and say what a repository would make known of people, and what it will ask for."""
    from stimuli.errors import InputError
    from study.record.contents import contents_of
    from study.record.crate import pack_crate
    from study.record.psychds import pack_psych_ds

    asked = [
        (pack, out)
        for pack, out in ((pack_psych_ds, args.psych_ds), (pack_crate, args.ro_crate))
        if out is not None
    ]
    if not asked:
        raise InputError("expected --psych-ds OUT or --ro-crate OUT, found neither")
    for pack, out in asked:
        pack(args.data, out)
        print(out)
    held = contents_of(args.data)
    if personal := held.personal:
        print(
            f"segue export: warning: {', '.join(personal)} of people are in it; "
            f"`segue anonymise {args.data} --out DIR` makes a copy without",
            file=sys.stderr,
        )
    lacking = [key for key in ("Authors", "License") if not held.document.get(key)]
    if lacking:
        print(
            f"segue export: warning: {args.data}/dataset_description.json has no "
            f"{' and no '.join(lacking)}, for which repositories ask; add it there, and to [lab] "
            "of the protocol",
            file=sys.stderr,
        )
    return 0
