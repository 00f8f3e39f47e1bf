"""A graph and its collection laid out for the search: what paths are scored by."""

import numpy as np
import numpy.typing as npt

from stimuli.collection import Collection, floor_frames
from stimuli.errors import InputError
from stimuli.graph.graph import MotionGraph
from stimuli.graph.score_loop import Space


def search_space(graph: MotionGraph, collection: Collection) -> Space:
    """The space of all paths of a graph; InputError where it is of another collection."""
    if graph.collection != collection.hash:
        raise InputError(
            "graph: expected one of these clips, found one of others.\nBuild it anew, or name the "
            "clips that it is of with --motions."
        )
    from stimuli.graph.summary_loop import forest

    clips = len(collection)
    floors = [floor_frames(motion) for motion in collection.motions]
    place = np.concatenate([floor.place for floor in floors])
    yaw = np.concatenate([floor.yaw for floor in floors])
    clip = np.repeat(np.arange(clips), graph.frames)
    entered = np.concatenate([np.arange(n) for n in graph.frames]) - 1  # the frame before a start
    begins = collection.starts.astype(np.int64)
    labels, right, leaf, roots, of_clip = forest(
        np.zeros(len(clip), np.int64), entered, np.zeros(len(clip)), begins
    )
    nodes = len(graph.right)
    starts = labels[leaf].astype(np.int32)
    of_node = np.repeat(of_clip, np.diff(np.append(roots, len(right))))
    root_from = np.append(graph.root_from, np.full(len(roots), clips)).astype(np.int32)
    root_to = np.append(graph.root_to, of_clip).astype(np.int32)
    cut = graph.labels[graph.leaf]
    return Space(
        first=collection.starts.astype(np.int32),
        frames=np.append(graph.frames, 0).astype(np.int32),
        exits=np.append(graph.exits, -1).astype(np.int32),
        place=place[:, 1] + 1j * place[:, 0],
        turn=np.exp(1j * yaw),
        node_from=np.append(graph.node_from, np.full(len(right), clips)).astype(np.int32),
        node_to=np.append(graph.node_to, of_node).astype(np.int32),
        node_i=np.append(cut[:, 0], np.full(len(right), -1)).astype(np.int32),
        node_j=np.append(cut[:, 1], starts[:, 1]).astype(np.int32),
        node_cost=np.append(cut[:, 2], np.zeros(len(right))).astype(np.float32),
        right=np.append(graph.right, np.where(right > 0, right + nodes, 0)).astype(np.int32),
        roots=np.concatenate([graph.roots, roots + nodes, [nodes + len(right)]]).astype(np.int32),
        pair=_pairs(root_from, root_to, clips),
    )


def _pairs(root_from: np.ndarray, root_to: np.ndarray, clips: int) -> npt.NDArray[np.int32]:
    """Where the trees of each pair of clips begin (N + 1, N + 2), with one column for the end."""
    keys = root_from.astype(np.int64) * (clips + 2) + root_to
    wanted = np.arange((clips + 1) * (clips + 2), dtype=np.int64)
    found = np.searchsorted(keys, wanted, side="left")
    return found.reshape(clips + 1, clips + 2).astype(np.int32)
