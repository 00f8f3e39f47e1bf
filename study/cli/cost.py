"""`segue cost`: the cost of a transition between every two frames of two clips."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stimuli.motion import Clip, Library
    from stimuli.motion.quaternions import Array
    from stimuli.transition.points import TransitionPoint

_SHOWN = 20  # of the minima are printed


def add_arguments(parser: argparse.ArgumentParser) -> None:
    from study.cli.common import (
        COUNT,
        SIGMA,
        add_motions_option,
        add_room_options,
        add_velocity_option,
    )

    parser.add_argument("from_clip", metavar="A", help="clip to leave, or a directory of clips")
    parser.add_argument("to_clip", metavar="B", help="clip to enter, or a directory of clips")
    parser.add_argument(
        "--weights",
        default="wang",
        help="lee, wang or FILE of role = weight (default wang)",
    )
    add_velocity_option(parser)
    add_room_options(parser)
    parser.add_argument(
        "--count",
        type=COUNT,
        default=50,
        metavar="N",
        help="points wanted of whole directories (default 50)",
    )
    parser.add_argument(
        "--sigma",
        type=SIGMA,
        help="σ of the transition probabilities (default: the mean of the frames' cheapest costs)",
    )
    parser.add_argument("--out", type=Path, metavar="cost.png", help="draw the matrix")
    parser.add_argument("--npz", type=Path, metavar="cost.npz", help="save the matrix")
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    add_motions_option(parser)


def run(args: argparse.Namespace) -> int:
    from stimuli.transition.distance import cost_matrix
    from stimuli.transition.plots import PICTURES, draw_cost
    from stimuli.transition.points import TRIVIAL, default_sigma, local_minima, probabilities
    from stimuli.transition.weights import read_weights
    from study.cli.clips import is_directory, open_library, tell_warnings
    from study.cli.common import check_outputs, check_room, print_json

    if any(is_directory(name) for name in (args.from_clip, args.to_clip)):
        return _search(args)
    check_outputs(("--out", args.out, PICTURES), ("--npz", args.npz, (".npz",)))
    weights = read_weights(args.weights)
    library = open_library(args.motions)
    a, b = _open(library, args.from_clip), _open(library, args.to_clip)
    tell_warnings(a, b)
    check_room(args, [a.motion], [b.motion])
    cost = cost_matrix(a.motion, b.motion, weights, args.velocity_weight)
    trivial = TRIVIAL if a.motion.same_as(b.motion) else -1
    minima = local_minima(cost, args.before, args.after, trivial)
    sigma = args.sigma or default_sigma(cost, trivial)
    likely = probabilities(cost, sigma)
    if args.out:
        draw_cost(cost, minima, (a.name, b.name), args.out)
    if args.npz:
        _save(args.npz, cost=cost, probability=likely, sigma=sigma)
    listed = [_entry(point, likely) for point in minima]
    if args.json:
        document = {"frames": list(cost.shape), "sigma": sigma}
        print_json(document | _minima(listed))
        return 0
    print(f"{a.name} ({cost.shape[0]} frames) to {b.name} ({cost.shape[1]}), cheapest first")
    print(f"from → to, cost, probability P(i, j) with σ = {sigma:.6g}")
    for entry in listed[:_SHOWN]:
        print(
            f"{entry['from']:5d} → {entry['to']:<5d} {entry['cost']:.6f}  "
            f"{entry['probability']:.4g}"
        )
    if len(listed) > _SHOWN:
        print(f"… and {len(listed) - _SHOWN} more local minima (--json lists them)")
    _say_if_none(listed, args)
    for path in (args.out, args.npz):
        if path:
            print(f"written: {path}")
    return 0


def _open(library: "Library", name: str) -> "Clip":
    """The clip of a name; one with a frame, as other commands want it, is refused as such."""
    from stimuli.errors import InputError
    from study.cli.clips import names_frame

    try:
        return library.load(name)
    except InputError:
        if not names_frame(name):
            raise
        clip = name.rpartition(":")[0]
        raise InputError(
            f"{name}: expected a clip without a frame, found one with: the cost is of every two "
            f"frames.\nGive {clip}."
        ) from None


def _search(args: argparse.Namespace) -> int:
    """The best transition points between whole directories, block by block."""
    from stimuli.errors import InputError
    from stimuli.transition.points import TRIVIAL
    from stimuli.transition.search import blocks, search
    from stimuli.transition.weights import read_weights
    from study.cli.clips import open_all
    from study.cli.common import check_room, print_json, progress

    if given := [f"--{name}" for name in ("out", "npz", "sigma") if getattr(args, name)]:
        raise InputError(
            f"{', '.join(given)}: expected two clips, found a directory, whose best points are "
            "printed.\nLeave it out, or name two clips."
        )
    weights = read_weights(args.weights)
    a, b = open_all(args.motions, [args.from_clip, args.to_clip])
    froms, tos = [clip.motion for clip in a], [clip.motion for clip in b]
    check_room(args, froms, tos)
    # among the same clips every point is found twice, once each way, and is printed once
    folded = not args.json and [clip.path for clip in a] == [clip.path for clip in b]
    with progress(blocks(froms, tos), "searching") as step:
        found = search(
            froms,
            tos,
            count=args.count * (2 if folded else 1),
            weights=weights,
            velocity_weight=args.velocity_weight,
            before=args.before,
            after=args.after,
            trivial=TRIVIAL,
            progress=step,
        )
    listed = [
        {
            "from_clip": a[point.from_motion].name,
            "from": point.i,
            "to_clip": b[point.to_motion].name,
            "to": point.j,
            "cost": point.cost,
        }
        for point in found
    ]
    if args.json:
        print_json({"frames": [sum(map(len, froms)), sum(map(len, tos))]} | _minima(listed))
        return 0
    if folded:
        listed = _folded(listed)[: args.count]
    print(f"the {len(listed)} cheapest of {len(a)} clips to {len(b)}, frames at 30 a second")
    for line in _columns(listed):
        print(line)
    _say_if_none(listed, args)
    return 0


def _columns(listed: list[dict[str, Any]]) -> list[str]:
    """Points between clips, one a line below a header, in columns."""
    if not listed:
        return []
    rows = [("from", " ", "to", "cost")]
    rows += [
        (start, entry.get("way", "→"), end, f"{entry['cost']:.6f}")
        for entry, (start, end) in ((entry, _ends(entry)) for entry in listed)
    ]
    first, _, second, third = (max(map(len, column)) for column in zip(*rows, strict=True))
    return [f"{a:{first}} {way} {b:{second}}  {cost:>{third}}" for a, way, b, cost in rows]


def _folded(listed: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Points of clips among themselves, those found both ways once: the cost is symmetric."""
    found = {_ends(entry) for entry in listed}
    kept: dict[tuple[str, str], dict[str, Any]] = {}
    for entry in listed:
        there, back = _ends(entry), _ends(entry)[::-1]
        if back not in kept:
            kept[there] = entry | {"way": "↔" if back in found else "→"}
    return list(kept.values())


def _ends(entry: dict[str, Any]) -> tuple[str, str]:
    """Both ends of a point, as CLIP:FRAME."""
    start, end = ((entry[f"{side}_clip"], entry[side]) for side in ("from", "to"))
    return f"{start[0]}:{start[1]}", f"{end[0]}:{end[1]}"


def _entry(point: "TransitionPoint", likely: "Array") -> dict[str, Any]:
    chance = float(likely[point.i, point.j])
    return {"from": point.i, "to": point.j, "cost": point.cost, "probability": chance}


def _minima(listed: list[dict[str, Any]]) -> dict[str, Any]:
    """The least of the minima, null where there is none, and all of them."""
    return {"minimum": listed[0] if listed else None, "local_minima": listed}


def _say_if_none(listed: list[dict[str, Any]], args: argparse.Namespace) -> None:
    if not listed:
        room = f"{args.before} frames before it and {args.after} after it"
        print(f"none: no local minimum has {room}, apart from a motion going on into itself")


def _save(path: Path, **arrays: object) -> None:
    """An npz, whole or not at all."""
    from io import BytesIO

    import numpy as np

    from stimuli.files import write_atomic

    buffer = BytesIO()
    np.savez_compressed(buffer, **arrays)  # type: ignore[arg-type]
    write_atomic(path, buffer.getvalue())
