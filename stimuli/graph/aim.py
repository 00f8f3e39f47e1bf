"""Demands brought to arrays for the search, and what a collection cannot meet of them."""

from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from stimuli.collection import Collection, floor_frames
from stimuli.graph.demands import Demand, Demands, Wrong
from stimuli.graph.graph import MotionGraph
from stimuli.graph.score_loop import Aim
from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import forward, headings
from stimuli.motion.quaternions import Array


class Effort(NamedTuple):
    """How a search spends its time."""

    beam: int = 32  # ways that are kept up to the time of each demand
    walks: int = 2000  # ways that are tried from one demand to the next each time
    patience: int = 3000  # random mutations in a row that are no better, before all are tried
    kept: int = 3  # of ten climbs begin at a kept path, the others at a new one


def unmet_faults(demands: Demands, collection: Collection, graph: MotionGraph) -> Iterator[Wrong]:
    """What a collection cannot meet: clips, frames, joints and labels that it does not have."""
    labels = {span.label for spans in collection.spans for span in spans}
    for demand in demands.demands:
        if demand.kind == "joint" and demand["role"] not in collection.skeleton.roles:
            known = ", ".join(collection.skeleton.roles)
            yield (
                (*demand.path, "role"),
                f"expected a role of the body ({known}), found {demand['role']!r}",
            )
        if demand.kind == "style" and demand["label"].lower() not in labels:
            known = ", ".join(sorted(labels)[:30])
            yield (
                (*demand.path, "label"),
                f"expected one of {known or 'no labels at all'}, found {demand['label']!r}",
            )
        if demand.kind == "pose":
            yield from _pose_faults(demand, collection)
    if not any(True for d in demands.of("pose") for _ in _pose_faults(d, collection)):
        yield from _apart(demands, collection, graph)


def _pose_faults(demand: Demand, collection: Collection) -> Iterator[Wrong]:
    clip = demand["clip"]
    if clip not in collection.names:
        known = ", ".join(collection.names[:8])
        yield (
            (*demand.path, "clip"),
            f"expected a clip of the collection ({known} …), found {clip!r}",
        )
        return
    last = len(collection.motions[collection.place(clip)]) - 1
    if demand["frame"] > last:
        yield (*demand.path, "frame"), f"expected 0 to {last} of {clip}, found {demand['frame']}"


def _apart(demands: Demands, collection: Collection, graph: MotionGraph) -> Iterator[Wrong]:
    """Poses in parts of the graph of which the later cannot be reached from the earlier."""
    from scipy.sparse.csgraph import shortest_path

    poses = demands.of("pose")
    hops = shortest_path(graph.joined, unweighted=True) if len(poses) > 1 else None
    for one, other in pairwise(poses):
        here, there = (collection.place(pose["clip"]) for pose in (one, other))
        if here != there and hops is not None and np.isinf(hops[here, there]):
            yield (
                (*other.path, "clip"),
                f"no way leads here from {one['clip']}: they are in parts of the graph that are "
                f"not connected, of {_part(graph, here)} and of {_part(graph, there)}; take a "
                "larger --tau or other poses",
            )


def _part(graph: MotionGraph, clip: int) -> str:
    members = [graph.names[n] for n in np.flatnonzero(graph.parts == graph.parts[clip])]
    more = f" and {len(members) - 3} more" if len(members) > 3 else ""
    return ", ".join(members[:3]) + more


def aim_at(demands: Demands, collection: Collection) -> Aim:
    """The demands of a figure as arrays, weights multiplied in; what they name is there.

    An error of 10 frames counts as 30 cm and as 10°, each as one; so does a cut of cost 1.
    """
    weights = demands.weights
    bodies, joints, styles = (demands.of(kind) for kind in ("body", "joint", "style"))
    avoid, poses = demands.of("avoid"), demands.of("pose")
    local, step = _joint_tracks(collection, [joint["role"] for joint in joints])
    every, reach = _all_joints(collection) if avoid else _no_joints(collection)
    velocity = [joint["velocity"] or [np.nan] * 3 for joint in joints]
    return Aim(
        frames=demands.frames,
        shortest=demands.shortest,
        cut_weight=weights["cuts"],
        frames_weight=weights["frames"],
        body_at=_whole(body["at"] for body in bodies),
        body_place=np.array([complex(b["place"][1], b["place"][0]) for b in bodies], dtype=complex),
        body_turn=np.exp(1j * np.radians([float(body["heading"]) for body in bodies])),
        body_weight=weights["body"] * _numbers(body["weight"] for body in bodies),
        joint_at=_whole(joint["at"] for joint in joints),
        joint_place=_rows([joint["place"] for joint in joints], 3),
        joint_velocity=_rows(velocity, 3) / collection.motions[0].fps,
        joint_weight=weights["joint"] * _numbers(joint["weight"] for joint in joints),
        joint_local=local,
        joint_step=step,
        style_from=_whole(style["from"] for style in styles),
        style_to=_whole(style["to"] for style in styles),
        style_weight=weights["style"] * _numbers(style["weight"] for style in styles),
        style_count=_labelled(collection, [style["label"].lower() for style in styles]),
        avoid_kind=_whole(0 if place["centre"] else 1 for place in avoid),
        avoid_shape=_rows([_shape(place) for place in avoid], 6),
        avoid_weight=weights["avoid"] * _numbers(place["weight"] for place in avoid),
        joints=every,
        reach=reach,
        stops=_stops(demands),
        effort=_whole(Effort()),
        locked=0,
        pose_at=_whole(pose["at"] for pose in poses),
        pose_clip=_whole(collection.place(pose["clip"]) for pose in poses),
        pose_frame=_whole(pose["frame"] for pose in poses),
    )


def _whole(values: Iterable[int]) -> np.ndarray:
    return np.fromiter(values, dtype=np.int32)


def _numbers(values: Iterable[float]) -> Array:
    return np.fromiter(values, dtype=float)


def _rows(values: list[list[float]], width: int) -> Array:
    return np.array(values, dtype=float).reshape(len(values), width)


def _shape(place: Demand) -> list[float]:
    """x, z, radius of a circle; x, y, z of the low and the high corner of a box, all heights of one
    on the floor."""
    if place["centre"]:
        return [*place["centre"], place["radius"], 0.0, 0.0, 0.0]
    low, high = place["low"], place["high"]
    if len(low) == 2:
        low, high = [low[0], -np.inf, low[1]], [high[0], np.inf, high[1]]
    return [*low, *high]


def _stops(demands: Demands) -> np.ndarray:
    """Times of demands, the last the whole length."""
    times = {d["at"] + 1 for kind in ("body", "joint") for d in demands.of(kind) if d["at"] > 0}
    ends = sorted(times | {demands.frames})
    return _whole(ends)


def _joint_tracks(collection: Collection, roles: list[str]) -> tuple[Array, Array]:
    """Where joints are in the torso frame (K, F, 3), and their steps to the next frame there."""
    joints = [collection.skeleton.roles[role] for role in roles]
    frames = int(collection.starts[-1])
    places, steps = np.zeros((len(joints), frames, 3)), np.zeros((len(joints), frames, 3))
    for clip, motion in enumerate(collection.motions if joints else ()):
        rows = slice(int(collection.starts[clip]), int(collection.starts[clip + 1]))
        positions, _ = forward(motion.skeleton, motion.rotations, motion.root)
        home = quat.about("Y", -headings(motion))[:, None]
        tracked = positions[:, joints]
        origin = (motion.root * np.array([1.0, 0.0, 1.0]))[:, None]
        moved = np.concatenate([np.diff(tracked, axis=0), tracked[-1:] - tracked[-2:-1]])
        places[:, rows] = quat.rotate(home, tracked - origin).transpose(1, 0, 2)
        steps[:, rows] = quat.rotate(home, moved).transpose(1, 0, 2)
    return places, steps


def _all_joints(collection: Collection) -> tuple[np.ndarray, np.ndarray]:
    """Every joint (F, J, 3) in the torso frame, and how far over the floor the farthest is."""
    each = []
    for motion in collection.motions:
        positions, _ = forward(motion.skeleton, motion.rotations, motion.root)
        floor = floor_frames(motion)
        origin = (motion.root * np.array([1.0, 0.0, 1.0]))[:, None]
        each.append(quat.rotate(quat.about("Y", -floor.yaw)[:, None], positions - origin))
    joints = np.concatenate(each)
    reach = np.hypot(joints[..., 0], joints[..., 2]).max(axis=1)
    return joints.astype(np.float32), reach.astype(np.float32)


def _no_joints(collection: Collection) -> tuple[np.ndarray, np.ndarray]:
    frames = int(collection.starts[-1])
    return np.zeros((frames, 0, 3), dtype=np.float32), np.zeros(frames, dtype=np.float32)


def _labelled(collection: Collection, labels: list[str]) -> np.ndarray:
    """How many frames before each (S, F + 1) have a label."""
    frames = int(collection.starts[-1])
    has = np.zeros((len(labels), frames), dtype=bool)
    for clip, spans in enumerate(collection.spans):
        first, stop = int(collection.starts[clip]), int(collection.starts[clip + 1])
        for span in spans:
            rows = slice(first + span.first, min(first + span.last + 1, stop))
            has[[n for n, label in enumerate(labels) if label == span.label], rows] = True
    counts = np.zeros((len(labels), frames + 1), dtype=np.int32)
    counts[:, 1:] = np.cumsum(has, axis=1)
    return counts
