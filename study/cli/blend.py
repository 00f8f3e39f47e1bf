"""`segue blend`: join two clips and write the result as BVH or as a video."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from stimuli.motion import Library
    from stimuli.transition import Transition


METHOD_NAMES = (
    "cut", "fixed", "geodesic", "velocity", "velocity-speed", "timewarp", "per-joint",
    "inertialization", "inertialization-spring", "dead-blending", "motion-graph", "manifold",
)  # fmt: skip
_SECONDS = 6.0  # of the clip around a cut that is looked for
_LONGEST = 120.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    from study.cli.clips import add_point_arguments
    from study.cli.common import (
        COUNT,
        TAU,
        add_motions_option,
        add_specification_option,
        argument,
        explain_points,
    )

    seconds = argument(float, f"seconds above 0, up to {_LONGEST:g}", lambda x: 0 < x <= _LONGEST)
    add_point_arguments(parser, "; a cut needs no frames and takes the cheapest")
    explain_points(parser)
    parser.add_argument(
        "--method",
        default="geodesic",
        help=f"{', '.join(METHOD_NAMES[:-1])} or {METHOD_NAMES[-1]} (default geodesic)",
    )
    parser.add_argument("--frames", type=int, help="length, instead of the method's own")
    add_specification_option(parser)
    parser.add_argument(
        "--weights",
        help="of the cost that a cut of clips without frames is cheapest by: lee, wang or FILE "
        "(default wang; only there)",
    )
    parser.add_argument(
        "--seconds",
        type=seconds,
        help="of clip that such a cut has around it, half before and half after "
        f"(default {_SECONDS:g}; only there)",
    )
    parser.add_argument(
        "--tau", type=TAU, default=1.0,
        help="cost below which motion-graph cuts, through all clips of --motions (default 1)",
    )  # fmt: skip
    parser.add_argument(
        "--neighbours", type=COUNT, default=7, metavar="K",
        help="of each frame in the embedding that manifold goes through (default 7)",
    )  # fmt: skip
    parser.add_argument("--smooth", action="store_true", help="ease the weights by a smoothstep")
    parser.add_argument("--no-foot-lock", action="store_true", help="let feet slide as they will")
    parser.add_argument(
        "--out",
        type=Path,
        required=True,
        metavar="FILE.bvh|.mp4|.mov|.mkv|.glb",
        help="what to write: the motion; a video, H.264 or lossless; the moving figure as glTF",
    )
    parser.add_argument(
        "--glb", action="store_true", help="write the moving figure as glTF too, beside FILE"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    add_motions_option(parser)


def run(args: argparse.Namespace) -> int:
    from study.cli.clips import names_frame, open_library
    from study.cli.common import check_outputs, print_json
    from study.cli.writing import MOTION_FILES, write_motion

    outputs = [args.out, *([args.out.with_suffix(".glb")] if args.glb else [])]
    check_outputs(*(("--out", path, MOTION_FILES) for path in outputs))
    framed = names_frame(args.from_point) or names_frame(args.to_point)
    join = _join if framed or args.method != "cut" else _best_cut
    joined, (i, j) = join(args, open_library(args.motions))
    for path in dict.fromkeys(outputs):
        write_motion(joined.motion, path)
    if args.json:
        print_json(
            {
                "out": str(args.out),
                "method": joined.method,
                "specification": joined.specification,
                "from": i,
                "to": j,
                "frames": joined.frames,
                "mixed": list(joined.mixed),
                "total_frames": len(joined.motion),
            }
        )
    else:
        whole = counted(len(joined.motion))
        print(f"{args.out}: {whole}, {joined.method} {i} → {j}, {_where(joined)}")
    return 0


def counted(frames: int) -> str:
    """A number of frames, in words."""
    return f"{frames} frame{'' if frames == 1 else 's'}"


def _where(joined: "Transition") -> str:
    """Where the joined motion is mixed; an even center-aligned length mixes one frame more."""
    first, last = joined.mixed
    if not joined.frames:
        return f"cut at {first}"
    mixed = f"frames {first}-{last}" if last > first else f"frame {first}"
    return f"{joined.specification}, length {joined.frames}, {mixed} mixed"


def _join(args: argparse.Namespace, library: "Library") -> tuple["Transition", tuple[int, int]]:
    """The transition between the two frames named, and their numbers."""
    from stimuli.errors import InputError
    from stimuli.transition import transition
    from study.cli.clips import open_point, tell_warnings

    idle = [f"--{name}" for name in ("weights", "seconds") if getattr(args, name) is not None]
    if idle:
        raise InputError(
            f"{', '.join(idle)}: expected --method cut and two clips without frames, found "
            f"--method {args.method} of {args.from_point} and {args.to_point}.\n"
            "Leave it out: it says which cut is looked for."
        )
    a, b = open_point(library, args.from_point), open_point(library, args.to_point)
    tell_warnings(a.clip, b.clip)
    route = None
    if args.method == "motion-graph":
        from study.cli.collections import shortest_route

        route = shortest_route(library, a, b, args.tau)
    elif args.method == "manifold":
        from stimuli.manifold import passing

        names = a.clip.name, b.clip.name
        route = passing(a.clip.motion, b.clip.motion, a.frame, b.frame, names, args.neighbours)
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
        route=route,
    )
    return joined, (a.frame, b.frame)


def _best_cut(args: argparse.Namespace, library: "Library") -> tuple["Transition", tuple[int, int]]:
    """The cheapest cut between two clips with room around it, and its frames in the clips."""
    from stimuli.errors import InputError
    from stimuli.transition.cuts import best_cut
    from stimuli.transition.weights import read_weights
    from stimuli.transition.window import specified
    from study.cli.clips import tell_warnings

    if args.frames:
        raise InputError(f"cut: expected no frames of blend, found {args.frames}.")
    specified(args.specification)
    weights = read_weights(args.weights or "wang")
    a, b = library.load(args.from_point), library.load(args.to_point)
    tell_warnings(a, b)
    frames = round((args.seconds or _SECONDS) * a.motion.fps)
    joined, point = best_cut(a.motion, b.motion, weights, frames, specification=args.specification)
    return joined, (point.i, point.j)
