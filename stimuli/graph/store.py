"""A graph on the disk: named by what it is made of, written whole, read with care."""

import hashlib
import json
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from stimuli.collection import Collection
from stimuli.errors import InputError
from stimuli.files import write_atomic
from stimuli.graph.build import build_graph
from stimuli.graph.graph import MotionGraph

_FORMAT = "segue-graph 1"
ARRAYS = {
    "frames": "i4", "labels": "f4", "right": "i4", "leaf": "i4",
    "roots": "i4", "root_from": "i4", "root_to": "i4",
}  # fmt: skip


def graph_key(collection: Collection, tau: float) -> str:
    """What names a graph: the frames of its clips and its settings."""
    made_of = [_FORMAT, collection.hash, float(tau).hex()]
    return hashlib.sha256(json.dumps(made_of).encode()).hexdigest()[:24]


def graph_place(collection: Collection, tau: float) -> Path:
    """Where a graph lies in the user's cache directory."""
    from platformdirs import user_cache_path

    folder = user_cache_path("segue", appauthor=False) / "graphs"
    return folder / f"{graph_key(collection, tau)}.npz"


def graph_kept(
    collection: Collection, tau: float, make: Callable[[Path], MotionGraph] | None = None
) -> MotionGraph:
    """The graph of the user's cache, else built and kept there, by `make` where that is given."""
    place = graph_place(collection, tau)
    if place.is_file():
        return read_graph(place, collection)
    if make is not None:
        return make(place)
    graph = build_graph(collection, tau)
    write_graph(graph, place)
    return graph


def write_graph(graph: MotionGraph, path: Path) -> None:
    """Write a graph, whole or not at all; the same graph is the same bytes."""
    head = {
        "format": _FORMAT,
        "names": list(graph.names),
        "tau": graph.tau,
        "collection": graph.collection,
    }
    buffer = BytesIO()
    arrays: dict[str, Any] = {name: getattr(graph, name) for name in ARRAYS}
    told = np.frombuffer(json.dumps(head, ensure_ascii=False).encode(), dtype=np.uint8)
    np.savez(buffer, head=told, **arrays)
    write_atomic(path, buffer.getvalue())


def read_graph(path: Path, collection: Collection | None = None) -> MotionGraph:
    """The graph of a file; InputError for one that is damaged, foreign, or of other clips."""
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as stored:
            head = json.loads(bytes(stored["head"]).decode())
            arrays = {name: stored[name] for name in ARRAYS}
    except FileNotFoundError:
        raise InputError(
            f"{path}: expected a graph, found no such file.\n`segue graph build` makes one."
        ) from None
    except (OSError, ValueError, KeyError, TypeError, EOFError, BadZipFile) as error:
        raise _refused(path, f"a damaged or foreign file ({_short(error)})") from error
    if not isinstance(head, dict) or head.get("format") != _FORMAT:
        raise _refused(path, "a file of another kind or version")
    if fault := _fault(head, arrays):
        raise _refused(path, f"a damaged one: {fault}")
    graph = MotionGraph(tuple(head["names"]), tau=head["tau"], collection=head["collection"],
                        **arrays)  # fmt: skip
    if collection is not None and graph.collection != collection.hash:
        raise _refused(path, "one of other clips, or of other frames of them")
    return graph


def _fault(head: dict[str, Any], arrays: dict[str, np.ndarray]) -> str | None:
    """What does not hold in a file, where something does not."""
    names = head.get("names")
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        return "no names of clips"
    if not isinstance(head.get("tau"), float) or not isinstance(head.get("collection"), str):
        return "no settings"
    for name, kind in ARRAYS.items():
        if arrays[name].dtype != np.dtype(f"<{kind}") or arrays[name].ndim != 1 + (
            name == "labels"
        ):
            return f"{name} of another type"
    nodes, roots = len(arrays["right"]), len(arrays["roots"])
    sizes = {"labels": nodes, "leaf": nodes, "root_from": roots, "root_to": roots,
             "frames": len(names)}  # fmt: skip
    if wrong := [name for name, size in sizes.items() if len(arrays[name]) != size]:
        return f"{wrong[0]} of another length"
    within = {"right": nodes, "leaf": nodes, "roots": nodes, "root_from": len(names),
              "root_to": len(names)}  # fmt: skip
    for name, end in within.items():
        if len(arrays[name]) and not 0 <= arrays[name].min() <= arrays[name].max() < end:
            return f"{name} beyond what there is"
    return None


def _refused(path: Path, found: str) -> InputError:
    return InputError(
        f"{path}: expected a graph of these clips, found {found}.\n"
        "Remove it, and build it anew with `segue graph build`."
    )


def _short(error: Exception) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0][:120]
