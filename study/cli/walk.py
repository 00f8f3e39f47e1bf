"""`segue graph search`: a motion for a file of demands, in words, as a picture, as a file."""

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from study.cli.common import COUNT, SEED, argument

if TYPE_CHECKING:
    from stimuli.collection import Collection
    from stimuli.graph import Demands, MotionGraph, MotionPlan, Search

SECONDS = argument(float, "seconds above 0, up to 86400", lambda x: 0 < x <= 86400)
JOININGS = ("smooth", "blend", "cut")


def add_search_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `segue graph search`."""
    parser.add_argument("demands", type=Path, metavar="DEMANDS.toml", help="what is demanded")
    parser.add_argument(
        "--seconds", type=SECONDS, default=5.0, help="to search for (default 5; Ctrl-C ends it)"
    )
    parser.add_argument(
        "--mutations", type=COUNT, metavar="N",
        help="end after so many, whatever the time: the same on every run",
    )  # fmt: skip
    parser.add_argument(
        "--count", type=COUNT, default=1, metavar="N", help="different answers wanted (default 1)"
    )
    parser.add_argument("--seed", type=SEED, default=0, help="of all chance (default 0)")
    parser.add_argument(
        "--near", type=Path, metavar="WALK.json",
        help="go on from an earlier answer, and keep of it what need not change",
    )  # fmt: skip
    parser.add_argument(
        "--joining", choices=JOININGS, default=JOININGS[0],
        help="how pieces are joined: smoothed (default), blended, or cut and left so",
    )  # fmt: skip
    parser.add_argument("--foot-lock", action="store_true", help="hold feet that stand")
    parser.add_argument(
        "--out", type=Path, metavar="walk.bvh|.mp4|.mkv",
        help="write the motion, and walk.json beside it for --near",
    )  # fmt: skip
    parser.add_argument("--plot", type=Path, metavar="plan.png", help="draw it from above")


def search(args: argparse.Namespace) -> int:
    """Search for every figure of the file; 0 with the best motions that were found."""
    from stimuli.graph import draw_plan, read_demands, search_space, unmet_faults
    from stimuli.transition.plots import PICTURES
    from study.cli.collections import open_graph
    from study.cli.common import check_outputs, print_json
    from study.cli.writing import MOTION_FILES

    check_outputs(("--out", args.out, MOTION_FILES), ("--plot", args.plot, PICTURES))
    file = read_demands(args.demands)
    collection, graph = open_graph(args)
    file.refuse([fault for d in file.figures for fault in unmet_faults(d, collection, graph)])
    space = search_space(graph, collection)
    earlier = _earlier(args.near) if args.near else {}
    documents, drawn = [], []
    for demands in file.figures:
        found, whole = _searched(args, demands, collection, graph, space, earlier)
        for n, plan in enumerate(found.plans(args.count)):
            place = _out(args, demands, n) if args.out else None
            documents.append(_written(args, plan, collection, graph, place, whole, found.tried))
            drawn += [plan] if n == 0 else []
            if not args.json:
                _tell(documents[-1], plan, collection, n)
    if args.plot:
        told = ", ".join(f"{plan.demands.name} S = {plan.score:.2f}".strip() for plan in drawn)
        draw_plan(drawn, collection, args.plot, f"{args.demands.name}: {told}")
        if not args.json:
            print(f"drawn: {args.plot}")
    if args.json:
        print_json({"answers": documents})
    return 0


def _searched(
    args: argparse.Namespace, demands: "Demands", collection: "Collection",
    graph: "MotionGraph", space: Any, earlier: dict[str, Any],
) -> tuple["Search", bool]:  # fmt: skip
    """The search for one figure, gone on with until it ends, and whether nobody ended it before."""
    from stimuli.graph import begin_search, near_answer
    from study.cli.common import progress

    near = None
    if earlier:
        if demands.name not in earlier:
            from stimuli.errors import InputError

            raise InputError(
                f"{args.near}: expected an answer for {demands.name or 'one figure'}, found "
                f"{', '.join(name or 'one figure' for name in earlier)}.\nGive that figure's own."
            )
        near = near_answer(earlier[demands.name], demands, collection)
    found = begin_search(demands, graph, collection, space, args.seed, near)
    label = f"searching {demands.name}".strip()
    hundredths = None if args.mutations else round(100 * args.seconds)
    with progress(hundredths, label) as step:
        whole = found.go(
            seconds=None if args.mutations else args.seconds,
            mutations=args.mutations,
            tell=lambda gone, best: step(min(round(100 * gone), hundredths or round(100 * gone))),
        )
    if not whole:
        print("interrupted: the best so far", file=sys.stderr)
    return found, whole


def _earlier(path: Path) -> dict[str, Any]:
    """The answers of a file by their figures; InputError for another file."""
    from stimuli.errors import InputError

    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        answers = document.get("answers", [document])
        return {entry["figure"]: entry for entry in reversed(answers) if entry["pieces"]}
    except OSError as error:
        raise InputError(f"{path}: expected an answer, found: {error.strerror}.") from error
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(
            f"{path}: expected an answer that `segue graph search` wrote (walk.json), found "
            "another file."
        ) from error


def _out(args: argparse.Namespace, demands: "Demands", n: int) -> Path:
    """Where an answer goes: walk.bvh, walk-NAME.bvh of a figure, walk-2.bvh of a second answer."""
    parts = [args.out.stem]
    parts += [demands.name] if demands.name else []
    parts += [str(n + 1)] if args.count > 1 else []
    return Path(args.out.with_name("-".join(parts) + args.out.suffix))


def _written(
    args: argparse.Namespace, plan: "MotionPlan", collection: "Collection", graph: "MotionGraph",
    place: Path | None, whole: bool, tried: int,
) -> dict[str, Any]:  # fmt: skip
    """The answer as JSON has it; its motion and itself on the disk where that is wanted."""
    from stimuli.files import write_atomic
    from stimuli.graph import assembled, plan_document
    from study.cli.writing import write_motion

    more = {"seed": args.seed, "tau": graph.tau, "collection": graph.collection,
            "mutations": tried, "interrupted": not whole, "joining": args.joining,
            "foot_lock": args.foot_lock, "file": str(place) if place else None}  # fmt: skip
    document = plan_document(plan, collection.names, **more)
    if place:
        write_motion(assembled(plan, collection, args.joining, args.foot_lock), place)
        text = json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False)
        write_atomic(place.with_suffix(".json"), text + "\n")
    return document


def _tell(document: dict[str, Any], plan: "MotionPlan", collection: "Collection", n: int) -> None:
    name = f"{document['figure']}, " if document["figure"] else ""
    terms = ", ".join(f"{key} {value:.2f}" for key, value in plan.terms.items() if value)
    print(f"{name}answer {n + 1}: S = {plan.score:.3f} ({terms or 'no term'})")
    for miss in plan.misses:
        print(f"  {miss}")
    for piece in document["pieces"]:
        print(f"  {piece['clip']} {piece['from_frame']}-{piece['to_frame']}")
    if document["file"]:
        print(f"  written: {document['file']}")
