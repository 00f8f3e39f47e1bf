"""`segue weights`: weights of the pose cost from transitions that people labelled."""

import argparse
import json
import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stimuli.motion import Library, Motion
    from stimuli.transition.fit import Fit, Labelled, LeftOut

_COLUMNS = ("from_clip", "from_frame", "to_clip", "to_frame", "good")
GOOD = {"1": True, "0": False, "true": True, "false": False, "yes": True, "no": False,
        "good": True, "bad": False}  # fmt: skip
TOLD = 3  # of the faults of a table, the first ones


@dataclass(frozen=True, eq=False)
class LabelledRow:
    """A labelled transition as the table names it."""

    from_point: str
    to_point: str
    transition: "Labelled"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    from study.cli.common import add_motions_option, add_room_options, add_velocity_option

    parser.add_argument(
        "labels",
        type=Path,
        metavar="LABELS.csv",
        help=f"columns {', '.join(_COLUMNS)}; good takes 1, true, yes or good, and 0, false, no or "
        "bad; frames are 0-based, at 30 a second",
    )
    add_velocity_option(parser)
    parser.add_argument(
        "--other",
        nargs=2,
        metavar=("A", "B"),
        help="clips of another performer, on which leaving one out is judged too",
    )
    add_room_options(parser)
    parser.add_argument(
        "--out", type=Path, metavar="weights.toml", help="write the weights (.toml or .json)"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    add_motions_option(parser)


def run(args: argparse.Namespace) -> int:
    from stimuli.files import write_atomic
    from stimuli.transition.distance import check_pair
    from stimuli.transition.fit import common_parts, design_matrix, fit_weights, leave_one_out
    from study.cli.clips import open_library
    from study.cli.common import check_outputs, check_room, print_json, progress

    check_outputs(("--out", args.out, tuple(WRITTEN)))
    library = open_library(args.motions)
    rows = read_labels(args.labels, library)
    labelled = [row.transition for row in rows]
    pairs = [(t.a, t.b) for t in labelled]
    other = None
    if args.other:
        first, second = (library.load(name).motion for name in args.other)
        check_pair(first, second)
        other = (first, second)
        pairs.append(other)
    for a, b in pairs:
        check_room(args, [a], [b])
    parts = common_parts([motion for pair in pairs for motion in pair])
    if len(labelled) < len(parts):
        print(
            f"segue: note: {len(labelled)} labels for {len(parts)} weights: many sets of weights "
            "agree with them as well; label more.",
            file=sys.stderr,
        )
    fit = fit_weights(*design_matrix(labelled, parts, args.velocity_weight), parts)
    with progress(len(labelled), "leaving one out") as step:
        own, foreign = leave_one_out(
            labelled, parts, args.velocity_weight, other, step, before=args.before, after=args.after
        )
    found = _document(rows, fit, own, foreign)
    if args.out:
        write_atomic(args.out, WRITTEN[args.out.suffix.lower()](found["parts"]))
    if args.json:
        print_json(found)
    else:
        _print_tables(found)
        if args.out:
            print(f"weights written: {args.out}")
    return 0


def read_labels(path: Path, library: "Library") -> list[LabelledRow]:
    """The labelled transitions of a CSV; InputError telling every fault with its line."""
    from stimuli.errors import InputError

    table = _read_table(path)
    if not table:
        raise InputError(f"{path}: expected a labelled transition a line, found the header alone.")
    rows, faults = [], []
    for line, entry in table:
        try:
            rows.append(_row(entry, library))
        except InputError as error:
            faults.append(f"line {line}: {str(error).splitlines()[0].rstrip('.')}")
    if faults:
        more = f" (and {len(faults) - TOLD} more)" if len(faults) > TOLD else ""
        raise InputError(f"{path}: {'; '.join(faults[:TOLD])}{more}.")
    return rows


def _read_table(path: Path) -> list[tuple[int, dict[str, str]]]:
    """Every row of a CSV with the line on which it ends; InputError where columns are missing."""
    from analysis.psychometric.table import read_table
    from stimuli.errors import InputError

    read = read_table(path)
    if absent := [column for column in _COLUMNS if column not in read.header]:
        raise InputError(
            f"{path}: expected columns {', '.join(_COLUMNS)}, found no {', '.join(absent)}."
        )
    empty = dict.fromkeys(read.header, "")
    return [(line, empty | dict(zip(read.header, row, strict=False))) for line, row in read.rows]


def _row(entry: Mapping[str, str], library: "Library") -> LabelledRow:
    """A row of the table with its clips; InputError for the first thing that is wrong with it."""
    from stimuli.errors import InputError
    from stimuli.transition.distance import check_pair
    from stimuli.transition.fit import Labelled

    word = entry["good"].strip()
    if word.lower() not in GOOD:
        raise InputError(f"good: expected 1 or 0, found {word!r}")
    a, i = _end(entry, "from", library)
    b, j = _end(entry, "to", library)
    check_pair(a, b)
    labelled = Labelled(a, b, i, j, GOOD[word.lower()])
    return LabelledRow(f"{entry['from_clip']}:{i}", f"{entry['to_clip']}:{j}", labelled)


def _end(entry: Mapping[str, str], side: str, library: "Library") -> "tuple[Motion, int]":
    """The motion and the frame that a row names on one side."""
    from stimuli.errors import InputError

    name, text = entry[f"{side}_clip"], entry[f"{side}_frame"].strip()
    motion = library.load(name).motion
    if not re.fullmatch(r"[0-9]{1,9}", text) or int(text) >= len(motion):
        raise InputError(
            f"{side}_frame: expected a frame of {name}, 0 to {len(motion) - 1}, found {text!r}"
        )
    return motion, int(text)


def _document(
    rows: Sequence[LabelledRow], fit: "Fit", own: "Sequence[LeftOut]", foreign: "Sequence[LeftOut]"
) -> dict[str, Any]:
    """What was found, as JSON has it; `foreign` is empty without another performer."""
    from stimuli.transition.fit import summary

    found: dict[str, Any] = {
        "weights": dict(fit.by_role()),
        "parts": {part: float(w) for part, w in zip(fit.parts, fit.weights, strict=True)},
        "residual": fit.residual,
        "good": sum(row.transition.good for row in rows),
        "bad": sum(not row.transition.good for row in rows),
        "leave_one_out": [_entry(row, left) for row, left in zip(rows, own, strict=True)],
        "summary": dict(summary(own)),
    }
    if foreign:
        found["other"] = [_entry(row, left) for row, left in zip(rows, foreign, strict=True)]
        found["other_summary"] = dict(summary(foreign))
    return found


def _entry(row: LabelledRow, left: "LeftOut") -> dict[str, Any]:
    """A row of the leave-one-out table: the label, then the best point with and without it."""
    without = left.without
    return {
        "row": left.row,
        "label": {"from": row.from_point, "to": row.to_point, "good": row.transition.good},
        "from": left.best.i,
        "to": left.best.j,
        "from_without": without and without.i,
        "to_without": without and without.j,
        "moved": left.moved,
        "reason": left.reason or None,
    }


def _as_toml(parts: Mapping[str, float]) -> str:
    lines = [f"{part} = {weight:.6g}" for part, weight in parts.items() if weight > 0]
    return "[weights]\n" + "\n".join(lines) + "\n"


def _as_json(parts: Mapping[str, float]) -> str:
    return json.dumps({"weights": dict(parts)}, indent=2) + "\n"


WRITTEN = {".toml": _as_toml, ".json": _as_json}  # files that `segue cost --weights` reads


def _print_tables(found: Mapping[str, Any]) -> None:
    print(f"{found['good']} good and {found['bad']} bad transitions; weights, largest 1:")
    for role, weight in found["weights"].items():
        print(f"  {role:14} {weight:.4f}")
    print("frames by which the best transition point moves when a label is left out:")
    judged = [found[key] for key in ("leave_one_out", "other") if key in found]
    titles = ["moved", "other"][: len(judged)]
    widths = [max(len(e["label"][end]) for e in judged[0]) for end in ("from", "to")]
    print(_line("from", "to", "label", titles, widths))
    for entries in zip(*judged, strict=True):
        label, reason = entries[0]["label"], entries[0]["reason"]
        moves = [f"cannot be left out: {reason}"] if reason else [str(e["moved"]) for e in entries]
        good = "good" if label["good"] else "bad"
        print(_line(label["from"], label["to"], good, moves, widths))
    for title, key in (("one left out", "summary"), ("another performer", "other_summary")):
        if key in found:
            print(f"{title}: {_told(found[key])}")


def _line(start: str, end: str, label: str, moves: Sequence[str], widths: Sequence[int]) -> str:
    first, second = widths
    columns = "  ".join(f"{move:>5}" for move in moves)
    return f"  {start:{first}}  {end:{second}}  {label:5}  {columns}"


def _told(summary: Mapping[str, Any]) -> str:
    if not summary["count"]:
        return "no label can be left out"
    return (
        f"{summary['unmoved']} of {summary['count']} best points unmoved, "
        f"moved {summary['mean']:.2f} frames on average, median {summary['median']:g}"
    )
