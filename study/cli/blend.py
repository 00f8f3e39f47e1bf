"""`segue blend`: join two clips and write the result as BVH or as a video."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from stimuli.motion import Library, Motion
    from stimuli.transition import Transition


def add_arguments(parser: argparse.ArgumentParser) -> None:
    from study.cli.clips import add_point_arguments
    from study.cli.common import add_motions_option

    add_point_arguments(parser, "; a cut needs no frames and takes the cheapest")
    parser.add_argument("--method", default="geodesic", help="default geodesic")
    parser.add_argument("--frames", type=int, help="length, instead of the method's own")
    parser.add_argument("--specification", default="start-end", help="or center-aligned")
    parser.add_argument(
        "--weights",
        default="wang",
        help="of the cost that a cut of clips without frames is cheapest by: lee, wang or FILE",
    )
    parser.add_argument("--smooth", action="store_true", help="ease the weights by a smoothstep")
    parser.add_argument("--no-foot-lock", action="store_true", help="let feet slide as they will")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="FILE.bvh|.mp4|.mkv", help="what to write"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    add_motions_option(parser)


def run(args: argparse.Namespace) -> int:
    from study.cli.clips import open_library
    from study.cli.common import check_outputs, print_json

    writers = {".bvh": _write_bvh, ".mp4": _write_video, ".mkv": _write_video}
    check_outputs(("--out", args.out, tuple(writers)))
    framed = ":" in args.from_point + args.to_point
    join = _best_cut if args.method == "cut" and not framed else _join
    joined, (i, j) = join(args, open_library(args.motions))
    writers[args.out.suffix.lower()](joined.motion, args.out)
    first, last = joined.mixed
    if args.json:
        print_json(
            {
                "out": str(args.out),
                "method": joined.method,
                "specification": joined.specification,
                "from": i,
                "to": j,
                "frames": joined.frames,
                "mixed": [first, last],
                "total_frames": len(joined.motion),
            }
        )
    else:
        print(
            f"{args.out}: {len(joined.motion)} frames, {joined.method} {joined.specification}, "
            f"{i} → {j}, {joined.frames} frames of blend at {first}-{last}"
        )
    return 0


def _join(args: argparse.Namespace, library: "Library") -> tuple["Transition", tuple[int, int]]:
    """The transition between the two frames named, and their numbers."""
    from stimuli.transition import transition
    from study.cli.clips import open_point, tell_warnings

    a, b = open_point(library, args.from_point), open_point(library, args.to_point)
    tell_warnings(a.clip, b.clip)
    joined = transition(
        a.motion,
        b.motion,
        a.place,
        b.place,
        method=args.method,
        specification=args.specification,
        frames=args.frames,
        smooth=args.smooth,
        foot_lock=not args.no_foot_lock,
    )
    return joined, (a.frame, b.frame)


def _best_cut(args: argparse.Namespace, library: "Library") -> tuple["Transition", tuple[int, int]]:
    """The cheapest cut between two clips with three seconds around it, and its frames."""
    from stimuli.transition.cuts import best_cut
    from stimuli.transition.weights import read_weights
    from study.cli.clips import tell_warnings

    weights = read_weights(args.weights)
    a, b = library.load(args.from_point), library.load(args.to_point)
    tell_warnings(a, b)
    joined = best_cut(a.motion, b.motion, weights)
    return joined, (joined.i, joined.j)


def _write_bvh(motion: "Motion", path: Path) -> None:
    from stimuli.motion.formats.bvh_write import write_bvh

    write_bvh(motion, path)


def _write_video(motion: "Motion", path: Path) -> None:
    from stimuli.render import write_clip

    write_clip(motion, path)
