"""`segue length`: how long a blend should last, by every method of chapter V."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from study.cli.clips import Point


def add_arguments(parser: argparse.ArgumentParser) -> None:
    from study.cli.clips import add_point_arguments
    from study.cli.common import add_motions_option

    add_point_arguments(parser)
    parser.add_argument("--specification", default="start-end", help="or center-aligned")
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
    for name, entry in found.items():
        print(f"{name:15} {entry['frames']:3d}  {_why(name, entry)}".rstrip())


def _why(name: str, entry: dict[str, Any]) -> str:
    if "joint" in entry:
        clamp = ", clamped" if entry["clamped"] else ""
        rad = f"{entry['difference']:.4f} rad at {entry['speed']:.4f} a frame"
        return f"{entry['joint']}: {rad}{clamp}"
    if "costs" in entry:
        return f"cost {min(cost for cost in entry['costs'] if cost is not None):.5f}"
    if "cost" in entry:
        return f"{entry['from_frames']} to {entry['to_frames']} frames, cost {entry['cost']:.5f}"
    return ""
