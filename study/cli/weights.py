"""`segue weights`: weights of the pose cost from transitions that people labelled."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stimuli.motion import Library
    from stimuli.transition.fit import Labelled, Left

COLUMNS = ("from_clip", "from_frame", "to_clip", "to_frame", "good")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    from study.cli.common import add_motions_option

    parser.add_argument("labels", type=Path, metavar="LABELS.csv", help=", ".join(COLUMNS))
    parser.add_argument(
        "--velocity-weight", type=float, default=1.0, metavar="NU", help="ν, 1 by default"
    )
    parser.add_argument(
        "--other",
        nargs=2,
        metavar=("A", "B"),
        help="clips of another performer, on which leaving one out is judged too",
    )
    parser.add_argument("--out", type=Path, metavar="weights.toml", help="write the weights")
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    add_motions_option(parser)


def run(args: argparse.Namespace) -> int:
    from stimuli.transition.fit import (
        common_parts,
        design_matrix,
        fit_weights,
        leave_one_out,
        summary,
    )
    from study.cli.clips import open_library
    from study.cli.common import print_json, progress

    library = open_library(args.motions)
    labelled = read_labels(args.labels, library)
    other = None
    if args.other:
        first, second = (library.load(name).motion for name in args.other)
        other = (first, second)
    parts = common_parts([m for t in labelled for m in (t.a, t.b)] + list(other or ()))
    fit = fit_weights(*design_matrix(labelled, parts, args.velocity_weight), parts)
    with progress(len(labelled), "leaving one out") as step:
        own, foreign = leave_one_out(labelled, parts, args.velocity_weight, other, step)
    found: dict[str, Any] = {
        "weights": dict(fit.by_role()),
        "parts": {part: float(w) for part, w in zip(fit.parts, fit.weights, strict=True)},
        "residual": fit.residual,
        "good": sum(t.good for t in labelled),
        "bad": sum(not t.good for t in labelled),
        "leave_one_out": [_entry(left) for left in own],
        "summary": dict(summary(own)),
    }
    if foreign:
        found |= {"other": [_entry(left) for left in foreign]}
        found |= {"other_summary": dict(summary(foreign))}
    if args.out:
        _write(args.out, found["parts"])
    if args.json:
        print_json(found)
    else:
        _print_table(found)
    return 0


def read_labels(path: Path, library: "Library") -> "list[Labelled]":
    """The labelled transitions of a CSV; InputError telling every fault with its line."""
    import csv

    from stimuli.errors import InputError
    from stimuli.transition.fit import Labelled

    try:
        with path.open(encoding="utf-8-sig", newline="") as stream:
            rows = list(csv.DictReader(stream))
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"{path}: expected a CSV of labelled transitions, found {error}."
        ) from None
    absent = [column for column in COLUMNS if not rows or column not in rows[0]]
    if absent:
        raise InputError(f"{path}: expected columns {', '.join(COLUMNS)}, found no {absent[0]}.")
    labelled, faults = [], []
    words = {"1": True, "0": False, "true": True, "false": False, "yes": True, "no": False,
             "good": True, "bad": False}  # fmt: skip
    for line, row in enumerate(rows, start=2):
        try:
            a, b = library.load(row["from_clip"]).motion, library.load(row["to_clip"]).motion
            i, j = int(row["from_frame"]), int(row["to_frame"])
            good = words[str(row["good"]).strip().lower()]
            if not (0 <= i < len(a) and 0 <= j < len(b)):
                raise ValueError(f"frames 0 to {len(a) - 1} and 0 to {len(b) - 1}")
            labelled.append(Labelled(a, b, i, j, good))
        except InputError as error:
            faults.append(f"line {line}: {str(error).splitlines()[0]}")
        except (KeyError, TypeError, ValueError) as error:
            faults.append(f"line {line}: expected frames of the clips and good 1 or 0 ({error})")
    if faults:
        more = f" (and {len(faults) - 3} more)" if len(faults) > 3 else ""
        raise InputError(f"{path}: {'; '.join(faults[:3])}{more}.")
    return labelled


def _entry(left: "Left") -> dict[str, int]:
    return {
        "row": left.row,
        "from": left.best.i,
        "to": left.best.j,
        "from_without": left.without.i,
        "to_without": left.without.j,
        "moved": left.moved,
    }


def _write(path: Path, parts: dict[str, float]) -> None:
    """A TOML file that `segue cost --weights` reads."""
    from stimuli.files import write_atomic

    lines = [f"{part} = {weight:.6g}" for part, weight in parts.items() if weight > 0]
    write_atomic(path, "[weights]\n" + "\n".join(lines) + "\n")


def _print_table(found: dict[str, Any]) -> None:
    print(f"{found['good']} good and {found['bad']} bad transitions; weights, largest 1:")
    for part, weight in found["parts"].items():
        print(f"  {part:10} {weight:.4f}")
    for title, key in (("one left out", "summary"), ("another performer", "other_summary")):
        if key in found:
            s = found[key]
            print(
                f"{title}: {s['unmoved']} of {s['count']} best points unmoved, "
                f"moved {s['mean']:.2f} frames on average, median {s['median']:g}"
            )
