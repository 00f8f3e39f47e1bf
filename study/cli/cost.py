"""`segue cost`: the cost of a transition between every two frames of two clips."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from stimuli.transition.points import Point


def add_arguments(parser: argparse.ArgumentParser) -> None:
    from study.cli.common import add_motions_option

    parser.add_argument("from_clip", metavar="A", help="clip to leave, or a directory of clips")
    parser.add_argument("to_clip", metavar="B", help="clip to enter, or a directory of clips")
    parser.add_argument("--weights", default="wang", help="lee, wang or FILE of role = weight")
    parser.add_argument(
        "--velocity-weight", type=float, default=1.0, metavar="NU", help="ν, 1 by default"
    )
    parser.add_argument(
        "--before", type=int, default=0, metavar="N", help="frames wanted before the transition"
    )
    parser.add_argument(
        "--after", type=int, default=0, metavar="N", help="frames wanted after the transition"
    )
    parser.add_argument(
        "--count", type=int, default=50, metavar="N", help="points wanted of whole directories"
    )
    parser.add_argument("--sigma", type=float, help="σ of the transition probabilities")
    parser.add_argument("--out", type=Path, metavar="cost.png", help="draw the matrix")
    parser.add_argument("--npz", type=Path, metavar="cost.npz", help="save the matrix")
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    add_motions_option(parser)


def run(args: argparse.Namespace) -> int:
    from stimuli.transition.distance import cost_matrix
    from stimuli.transition.points import local_minima, probabilities
    from stimuli.transition.weights import read_weights
    from study.cli.clips import open_library, tell_warnings
    from study.cli.common import print_json

    if any(Path(name).is_dir() for name in (args.from_clip, args.to_clip)):
        return _search(args)
    library = open_library(args.motions)
    a, b = library.load(args.from_clip), library.load(args.to_clip)
    tell_warnings(a, b)
    weights = read_weights(args.weights)
    cost = cost_matrix(a.motion, b.motion, weights, args.velocity_weight)
    same = a.sha256 == b.sha256
    minima = local_minima(cost, args.before, args.after, TRIVIAL if same else -1)
    if args.out:
        from stimuli.transition.plots import draw_cost

        draw_cost(cost, minima, (a.name, b.name), args.out)
    if args.npz:
        _save(args.npz, cost=cost, probability=probabilities(cost, args.sigma))
    if args.json:
        listed = [_entry(point) for point in minima]
        least = listed[0] if listed else None
        print_json({"frames": list(cost.shape), "minimum": least, "local_minima": listed})
    else:
        print(f"{a.name} ({cost.shape[0]} frames) to {b.name} ({cost.shape[1]}), cheapest first")
        for point in minima[:20]:
            print(f"{point.i:5d} → {point.j:<5d} {point.cost:.6f}")
        if len(minima) > 20:
            print(f"… and {len(minima) - 20} more local minima (--json lists them)")
    return 0


def _search(args: argparse.Namespace) -> int:
    """The best transition points between whole directories, block by block."""
    from stimuli.errors import InputError
    from stimuli.transition.search import blocks, search
    from stimuli.transition.weights import read_weights
    from study.cli.clips import open_all
    from study.cli.common import print_json, progress

    if args.out or args.npz:
        raise InputError("--out, --npz: expected two clips, found a directory; search prints.")
    if args.count < 1:
        raise InputError(f"--count: expected 1 or more, found {args.count}.")
    a, b = open_all(args.motions, [args.from_clip, args.to_clip])
    froms, tos = [clip.motion for clip in a], [clip.motion for clip in b]
    with progress(blocks(froms, tos), "searching") as step:
        found = search(
            froms,
            tos,
            count=args.count,
            weights=read_weights(args.weights),
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
        print_json({"frames": [sum(map(len, froms)), sum(map(len, tos))], "local_minima": listed})
    else:
        for entry in listed:
            print(
                f"{entry['from_clip']}:{entry['from']} → {entry['to_clip']}:{entry['to']}"
                f"   {entry['cost']:.6f}"
            )
    return 0


TRIVIAL = 15  # frames: half a second around the diagonal a motion goes on into itself


def _entry(point: "Point") -> dict[str, float]:
    return {"from": point.i, "to": point.j, "cost": point.cost}


def _save(path: Path, **arrays: object) -> None:
    """An npz, whole or not at all."""
    from io import BytesIO

    import numpy as np

    from stimuli.files import write_atomic

    buffer = BytesIO()
    np.savez_compressed(buffer, **arrays)  # type: ignore[arg-type]
    write_atomic(path, buffer.getvalue())
