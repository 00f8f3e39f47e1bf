"""The collection and the graph that a `segue graph` command works on: found, else built."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from study.cli.common import TAU, add_motions_option, progress

if TYPE_CHECKING:
    from stimuli.collection import Collection
    from stimuli.graph import MotionGraph
    from stimuli.motion import Library
    from stimuli.transition import Route
    from study.cli.clips import Point


def add_collection_options(parser: argparse.ArgumentParser, pruned: bool) -> None:
    """Which clips, how near frames must be to be joined; whether a graph may be `pruned`."""
    add_motions_option(parser)
    parser.add_argument(
        "--clips", action="append", metavar="PATTERN",
        help='only clips of such names, as "16_*" (repeatable; default: all)',
    )  # fmt: skip
    parser.add_argument(
        "--tau", type=TAU, default=1.0, help="cost below which frames may be joined (default 1)"
    )
    if pruned:
        parser.add_argument(
            "--connected", action="store_true",
            help="only clips of the largest strongly connected part: a motion can always go on",
        )  # fmt: skip
    parser.add_argument("--debug", action="store_true", help=argparse.SUPPRESS)


def open_collection(args: argparse.Namespace) -> "Collection":
    """The clips of the command line as one collection; what is left out is said."""
    from stimuli.collection import collected
    from study.cli.clips import open_library

    library = open_library(args.motions)

    def tell(note: str) -> None:
        print(note, file=sys.stderr)

    with progress(None, "reading clips") as step:
        collection = collected(library, args.clips or ("*",), tell, step)
    for remark in collection.remarks:
        tell(f"warning: {remark}")
    return collection


def open_graph(args: argparse.Namespace) -> tuple["Collection", "MotionGraph"]:
    """The collection and its graph: that of `--graph`, else the one kept, else built and kept.

    Of `--connected` ones the largest strongly connected part.
    """
    from stimuli.graph import graph_kept, largest_part, read_graph

    collection, tau = open_collection(args), args.tau
    if args.graph is not None:
        graph = read_graph(args.graph, collection)
    else:
        graph = graph_kept(collection, tau, lambda p: made_graph(collection, tau, p))
    return largest_part(collection, graph) if args.connected else (collection, graph)


def made_graph(
    collection: "Collection", tau: float, place: Path, scheduler: str | None = None
) -> "MotionGraph":
    """A graph built, on a cluster where one is named, and written to its place."""
    from stimuli.files import check_writable
    from stimuli.graph import build_graph, on_scheduler, write_graph

    check_writable(place)
    with progress(len(collection), "building the graph") as step:
        if scheduler is None:
            graph = build_graph(collection, tau, progress=step)
        else:
            with on_scheduler(scheduler) as mapped:
                graph = build_graph(collection, tau, mapped=mapped, progress=step)
    write_graph(graph, place)
    return graph


def shortest_route(library: "Library", a: "Point", b: "Point", tau: float) -> "Route":
    """The shortest way between two points, through the clips of the library of their hierarchy."""
    from stimuli.collection import gathered
    from stimuli.errors import InputError
    from stimuli.graph import graph_kept, route_of

    clips = []
    with progress(None, "reading clips") as step:
        paths = library.paths()
        for done, path in enumerate(paths, start=1):
            try:
                clip = library.load(path)
            except InputError as error:
                print(f"left out: {error}", file=sys.stderr)
            else:
                same = clip.motion.skeleton.same_hierarchy(a.clip.motion.skeleton)
                clips += [clip] if same else []
            step(done, len(paths))
    clips += [point.clip for point in (a, b) if point.clip not in clips]
    collection = gathered(clips)
    graph = graph_kept(collection, tau, lambda place: made_graph(collection, tau, place))
    start, end = ((clips.index(point.clip), point.frame) for point in (a, b))
    return route_of(graph, collection, start, end)
