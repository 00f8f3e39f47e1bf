"""The motion of a plan (section 4.2.3): pieces one behind the other, cuts smoothed, demands met."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from stimuli.collection import Collection
from stimuli.graph.graph import MotionGraph
from stimuli.graph.plan import MotionPlan, Stretch
from stimuli.graph.shortest import shortest_way
from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import heading, placed
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.transition import transition
from stimuli.transition.route import Cutting, Piece, Route, put_together
from stimuli.transition.smooth import smoothed_cut
from stimuli.transition.window import longest_fitting


def _bare_cut(a: Motion, b: Motion, i: int, j: int) -> Motion:
    """A cut that is left as it is."""
    return transition(a, b, i, j, method="cut").motion


def _blended_cut(a: Motion, b: Motion, i: int, j: int) -> Motion:
    """The dissertation's blend with its best length, both frames in its middle (Wang V.1)."""
    if not longest_fitting(a, b, i, j, "center-aligned"):
        return smoothed_cut(a, b, i, j)
    return transition(a, b, i, j, specification="center-aligned").motion


CUTTINGS: Mapping[str, Cutting] = MappingProxyType(
    {"smooth": smoothed_cut, "blend": _blended_cut, "cut": _bare_cut}
)


def assembled(
    plan: MotionPlan, collection: Collection, joining: str = "smooth", foot_lock: bool = False
) -> Motion:
    """The motion of a plan: begun where demanded, joined, and each body demand met.

    `joining` is a name of CUTTINGS: the paper's smoothing, blends, or cuts left as they are (then
    bodies too are left where they come).
    """
    first, *others = (_piece(piece, collection) for piece in plan.pieces)
    start = plan.demands.of("body")[0]
    place, yaw = np.array(start["place"], dtype=float), np.radians(start["heading"])
    begun = _placed_at(first.motion[first.first : first.last + 1], 0, place, float(yaw))
    motion, _ = put_together(begun, others, CUTTINGS[joining], foot_lock)
    motion = motion[: plan.frames]
    return motion if joining == "cut" else _brought(motion, plan)


def way_motion(way: Sequence[Stretch], collection: Collection) -> Motion:
    """The motion of a way from one frame to another, its cuts smoothed."""
    first, *others = (_piece(piece, collection) for piece in way)
    begun = first.motion[first.first : first.last + 1]
    motion, _ = put_together(begun, others)
    return motion[: sum(map(len, way))]


def route_of(
    graph: MotionGraph, collection: Collection, start: tuple[int, int], end: tuple[int, int]
) -> Route:
    """The shortest way from a frame (clip, frame) to another as what a transition goes through."""
    way = shortest_way(graph, start, end)
    first = way[0]
    pieces = [Stretch(first.clip, first.first + 1, first.last), *way[1:]]
    return Route(
        collection.names[start[0]],
        start[1],
        end[1],
        tuple(_piece(piece, collection) for piece in pieces if len(piece)),
        sum(piece.cost for piece in way[1:]),
    )


def _piece(stretch: Stretch, collection: Collection) -> Piece:
    motion = collection.motions[stretch.clip]
    return Piece(collection.names[stretch.clip], motion, stretch.first, stretch.last)


def _heading_at(motion: Motion, frame: int) -> float:
    return float(heading(motion.skeleton, motion.rotations[frame], motion.root[frame]))


def _placed_at(motion: Motion, frame: int, place: Array, yaw: float) -> Motion:
    """The motion, turned and moved so that a frame of it is at a place in a heading."""
    turn = yaw - _heading_at(motion, frame)
    shift = -quat.rotate(quat.about("Y", turn), motion.root[frame])
    return placed(motion, turn, np.array([place[0] + shift[0], 0.0, place[1] + shift[2]]))


def _brought(motion: Motion, plan: MotionPlan) -> Motion:
    """What is left of each body demand spread evenly over the frames before it.

    What comes behind is carried along. A demand beyond the end is left.
    """
    before = 0
    for body in plan.demands.of("body")[1:]:
        at = body["at"]
        if at >= len(motion):
            break
        motion = _spread(motion, before, at, np.array(body["place"], float), body["heading"])
        before = at
    return motion


def _spread(motion: Motion, before: int, at: int, place: Array, degrees: float) -> Motion:
    """Frame `at` brought to a place and heading, in even steps from frame `before` on."""
    turn = np.radians(degrees) - _heading_at(motion, at)
    turn = float((turn + np.pi) % (2 * np.pi) - np.pi)
    after = _placed_at(motion, at, place, np.radians(degrees))
    part = np.arange(before + 1, at + 1)
    share = (part - before) / (at - before)
    shift = after.root[at] - motion.root[at]
    rotations = np.concatenate([motion.rotations[: at + 1], after.rotations[at + 1 :]])
    root = np.concatenate([motion.root[: at + 1], after.root[at + 1 :]])
    rotations[part, 0] = quat.multiply(quat.about("Y", share * turn), rotations[part, 0])
    root[part] += share[:, None] * shift
    return Motion(motion.skeleton, rotations, root, motion.fps)
