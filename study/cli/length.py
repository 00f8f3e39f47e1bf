"""`segue length`: how long a blend should last, by every method of chapter V."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from study.cli.clips import Point


def add_arguments(parser: argparse.ArgumentParser) -> None:
    from study.cli.clips import add_point_arguments
    from study.cli.common import add_motions_option, add_specification_option, explain_points

    add_point_arguments(parser)
    explain_points(parser)
    add_specification_option(parser)
    parser.add_argument(
        "--out", type=Path, metavar="length.png", help="draw the cost curve and each joint's"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    add_motions_option(parser)


def run(args: argparse.Namespace) -> int:
    from stimuli.transition.plots import PICTURES, draw_lengths
    from study.cli.clips import open_library, open_point, tell_warnings
    from study.cli.common import check_outputs, print_json

    check_outputs(("--out", args.out, PICTURES))
    library = open_library(args.motions)
    a, b = open_point(library, args.from_point), open_point(library, args.to_point)
    tell_warnings(a.clip, b.clip)
    found = lengths(a, b, args.specification)
    if args.out:
        title = f"{a.clip.name}:{a.frame} to {b.clip.name}:{b.frame}, {args.specification}"
        draw_lengths(a.motion, b.motion, a.place, b.place, args.specification, args.out, title)
    if args.json:
        print_json(found)
    else:
        _print_table(found, args.specification)
        if args.out:
            print(f"drawn: {args.out}")
    return 0


def lengths(a: "Point", b: "Point", specification: str) -> dict[str, Any]:
    """What every method says of a transition, as JSON has it."""
    from stimuli.transition import blend_length

    def by(method: str) -> Any:
        return blend_length(a.motion, b.motion, a.place, b.place, method, specification)

    fixed, geodesic, warp = by("fixed"), by("geodesic"), by("timewarp")
    costs = [None if cost != cost else float(cost) for cost in geodesic.report["costs"]]
    speeds = {
        name: {"frames": length.frames}
        | {key: length.report[key] for key in ("joint", "difference", "speed", "clamped")}
        for name, length in ((name, by(name)) for name in ("velocity", "velocity-speed"))
    }
    return {
        "fixed": {"frames": fixed.frames},
        "geodesic": {"frames": geodesic.frames, "costs": costs},
        **speeds,
        "timewarp": {"frames": warp.frames} | dict(warp.report),
    }


def _print_table(found: dict[str, Any], specification: str) -> None:
    print(f"{specification}, frames at 30 a second")
    costs = found["geodesic"]["costs"]
    for name, entry in found.items():
        print(f"{name:15} {entry['frames']:3d}  {_why(entry, costs)}".rstrip())


def _why(entry: dict[str, Any], costs: Sequence[float | None]) -> str:
    """How a method came to its length; `costs` are of 1, 2, … frames, None where none fits."""
    if "joint" in entry:
        clamp = ", clamped" if entry["clamped"] else ""
        rad = f"{entry['difference']:.4f} rad at {entry['speed']:.4f} a frame"
        return f"{entry['joint']}: {rad}{clamp}"
    if "costs" in entry:
        return f"cost {costs[entry['frames'] - 1]:.5f}{_at_the_end(entry['frames'], costs)}"
    if "cost" in entry:
        return f"{entry['from_frames']} to {entry['to_frames']} frames, cost {entry['cost']:.5f}"
    if costs[entry["frames"] - 1] is None:
        return f"does not fit: the clips allow {_longest(costs)} at most"
    return ""


def _longest(costs: Sequence[float | None]) -> int:
    return max(n for n, cost in enumerate(costs, start=1) if cost is not None)


def _at_the_end(frames: int, costs: Sequence[float | None]) -> str:
    """Words for an optimum that is none: the last length there is, with the curve falling to it."""
    if frames == 1 or frames < _longest(costs):
        return ""
    limit = "that the clips allow" if frames < len(costs) else "that is tried"
    return f", the longest {limit}: the curve still falls"
