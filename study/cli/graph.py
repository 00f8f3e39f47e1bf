"""`segue graph`: motion graphs, built, shown, and searched for motions that meet demands."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stimuli.collection import Collection
    from stimuli.graph import MotionGraph

KINDS = {
    "build": "build the motion graph of a collection of clips",
    "show": "what a graph holds, in numbers and as a picture",
    "search": "a motion that meets the demands of a file",
    "path": "the shortest way from a frame to another, in frames",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    from study.cli.collections import add_collection_options
    from study.cli.walk import add_search_arguments

    kinds = parser.add_subparsers(dest="kind", metavar="|".join(KINDS), required=True)
    made = {}
    for kind, told in KINDS.items():
        made[kind] = kinds.add_parser(kind, help=told, description=told)
        if kind != "build":
            made[kind].add_argument(
                "--graph", type=Path, metavar="FILE", help="a graph built with --out"
            )
    build, show, search, path = made.values()
    build.add_argument(
        "--out", type=Path, metavar="FILE.npz", help="default: kept where `segue graph` looks"
    )
    build.add_argument("--scheduler", metavar="ADDRESS", help="build on a Dask cluster")
    show.add_argument("--out", type=Path, metavar="graph.png", help="draw clips, and one pair")
    show.add_argument("--pair", nargs=2, metavar=("A", "B"), help="clips whose edges are drawn")
    show.add_argument(
        "--reach", type=float, metavar="SECONDS", help="also what is reached within so long"
    )
    show.add_argument("--reach-out", type=Path, metavar="reach.png", help="and a picture of it")
    add_search_arguments(search)
    path.add_argument("from_point", metavar="A:i", help="clip and frame to leave")
    path.add_argument("to_point", metavar="B:j", help="clip and frame to reach")
    path.add_argument("--out", type=Path, metavar="FILE.bvh|.mp4|.mkv", help="write the motion")
    for sub in made.values():
        sub.add_argument("--json", action="store_true", help="print one JSON document")
        add_collection_options(sub, pruned=sub is not build)


def run(args: argparse.Namespace) -> int:
    from stimuli.errors import InputError
    from study.cli.walk import search

    try:
        return {"build": _build, "show": _show, "search": search, "path": _path}[args.kind](args)
    except MemoryError as error:
        raise InputError(
            f"graph at tau {args.tau:g}: expected a graph that fits into free memory, found one "
            "that does not.\nTake a smaller --tau or fewer clips (--clips, --motions)."
        ) from error


def _build(args: argparse.Namespace) -> int:
    from stimuli.graph import graph_place
    from study.cli.collections import made_graph, open_collection
    from study.cli.common import check_outputs

    check_outputs(("--out", args.out, (".npz",)))
    collection = open_collection(args)
    place = args.out or graph_place(collection, args.tau)
    graph = made_graph(collection, args.tau, place, args.scheduler)
    return _tell(args, graph, {"file": str(place)})


def _show(args: argparse.Namespace) -> int:
    from stimuli.graph import draw_graph
    from stimuli.transition.plots import PICTURES
    from study.cli.collections import open_graph
    from study.cli.common import check_outputs

    check_outputs(("--out", args.out, PICTURES), ("--reach-out", args.reach_out, PICTURES))
    collection, graph = open_graph(args)
    more: dict[str, Any] = {}
    if args.out:
        pair = None
        if args.pair:
            pair = (collection.place(args.pair[0]), collection.place(args.pair[1]))
        draw_graph(graph, args.out, pair)
        more["drawn"] = str(args.out)
    if args.reach or args.reach_out:
        more |= _reached(args, collection, graph)
    return _tell(args, graph, more)


def _reached(
    args: argparse.Namespace, collection: "Collection", graph: "MotionGraph"
) -> dict[str, Any]:
    """How much of the floor and of headings is reached within a time."""
    from stimuli.errors import InputError
    from stimuli.graph import draw_reach, places_reached, search_space, shares

    seconds = args.reach or 3.0
    if not 0 < seconds <= 60:
        raise InputError(f"--reach: expected seconds above 0, up to 60, found {seconds:g}.")
    space = search_space(graph, collection)
    place, yaw = places_reached(space, round(30 * seconds), 20_000)
    if not len(yaw):
        raise InputError(f"--reach: expected motions of {seconds:g} s, found none that lasts.")
    floor, headings = shares(place, yaw)
    if args.reach_out:
        draw_reach(place, yaw, seconds, args.reach_out)
    return {"reach_seconds": seconds, "floor_m2": round(floor, 2), "headings": round(headings, 3)}


def _tell(args: argparse.Namespace, graph: "MotionGraph", more: dict[str, Any]) -> int:
    from study.cli.common import print_json

    numbers = numbers_of(graph)
    if args.json:
        print_json(numbers | more)
        return 0
    print(
        f"{numbers['clips']} clips, {numbers['frames']} frames, tau {graph.tau:g}: "
        f"{numbers['edges']:,} edges in {numbers['clusters']:,} clusters between "
        f"{numbers['pairs']} pairs of clips"
    )
    print(
        f"{numbers['connected']} clips in the largest strongly connected part"
        + (f"; outside it: {_few(numbers['outside'])}" if numbers["outside"] else "")
    )
    print(f"{numbers['dead_frames']} frames lead nowhere: the ends of clips, and what leads there")
    for key, value in more.items():
        print(f"{key.replace('_', ' ')}: {value}")
    return 0


def _few(names: list[str]) -> str:
    return ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")


def numbers_of(graph: "MotionGraph") -> dict[str, Any]:
    """What `segue graph build` and `show` say of a graph."""
    behind = (graph.frames - 1 - graph.exits).sum()
    return {
        "clips": len(graph.names),
        "frames": int(graph.frames.sum()),
        "tau": graph.tau,
        "edges": len(graph.cuts),
        "clusters": len(graph.roots),
        "pairs": int(graph.joined.sum()),
        "connected": int((graph.parts == 0).sum()),
        "outside": [graph.names[n] for n in (graph.parts > 0).nonzero()[0]],
        "dead_frames": int(behind),
        "leads_on_until": dict(zip(graph.names, graph.exits.tolist(), strict=True)),
    }


def _path(args: argparse.Namespace) -> int:
    from stimuli.graph import shortest_way
    from study.cli.collections import open_graph
    from study.cli.common import check_outputs, print_json
    from study.cli.writing import MOTION_FILES

    check_outputs(("--out", args.out, MOTION_FILES))
    collection, graph = open_graph(args)
    ends = [_place(collection, text) for text in (args.from_point, args.to_point)]
    way = shortest_way(graph, *ends)
    frames = sum(map(len, way)) - 1
    cost = sum(piece.cost for piece in way[1:])
    pieces = [
        {"clip": collection.names[p.clip], "from_frame": p.first, "to_frame": p.last,
         "cut_cost": p.cost}
        for p in way
    ]  # fmt: skip
    if args.out:
        _write_way(collection, way, args.out)
    if args.json:
        print_json({"frames": frames, "cuts": len(way) - 1, "cost": cost, "pieces": pieces})
        return 0
    print(f"{frames} frames, {len(way) - 1} cuts that cost {cost:.3f}")
    for piece in pieces:
        print(f"  {piece['clip']} {piece['from_frame']}-{piece['to_frame']}")
    return 0


def _place(collection: "Collection", text: str) -> tuple[int, int]:
    """The clip and frame that CLIP:FRAME names in a collection."""
    from stimuli.errors import InputError
    from study.cli.clips import split_point

    name, frame = split_point(text)
    if frame is None:
        raise InputError(f"{text}: expected CLIP:FRAME, such as walk:42.")
    clip = collection.place(name if name in collection.names else Path(name).stem)
    last = len(collection.motions[clip]) - 1
    if frame > last:
        raise InputError(f"{text}: expected a frame from 0 to {last}, found {frame}.")
    return clip, frame


def _write_way(collection: "Collection", way: Any, out: Path) -> None:
    from stimuli.graph import way_motion
    from study.cli.writing import write_motion

    write_motion(way_motion(way, collection), out)
