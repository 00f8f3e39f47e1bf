"""The score S of a path (eq. 1), compiled: O(1) for a piece, however long it is.

Rows on the floor are complex numbers z + ix, so that a turn by a heading θ is a product with
e^{iθ}. A piece is placed so that the frame before its first lies where the last frame of the piece
before it would be.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from stimuli.compiled import compiled, inlined
from stimuli.graph.arrays import Complex, Indices
from stimuli.motion.quaternions import Array

MOST_NODES = 96  # edges of a path
TEN_DEGREES = np.pi / 18


class Space(NamedTuple):
    """What paths are made of: frames of all clips in a row, and nodes of the hierarchy.

    The last clip is none: edges that leave it are those at which a motion starts.
    """

    first: Indices  # (N + 1,) where each clip's frames begin
    frames: Indices  # (N + 1,) of each clip
    exits: Indices  # (N + 1,)
    place: Complex  # (F,) on the floor
    turn: Complex  # (F,) e^{iθ} of the heading
    node_from: Indices  # (M,) clip left
    node_to: Indices  # (M,) clip entered
    node_i: Indices  # (M,) frame left, of the leaf that stands for a node
    node_j: Indices  # (M,) frame entered
    node_cost: npt.NDArray[np.float32]  # (M,)
    right: Indices  # (M,) second child, 0 for a leaf
    roots: Indices  # (R + 1,) where each tree begins, by clip left, then clip entered
    pair: Indices  # (N + 1, N + 2) index into `roots` of the first tree of a pair of clips


class Aim(NamedTuple):
    """Demands as arrays; each kind in order of time. Weights are in them."""

    frames: int
    shortest: int  # frames of a piece
    cut_weight: float
    frames_weight: float
    body_at: Indices  # (B,) the first at frame 0
    body_place: Complex
    body_turn: Complex
    body_weight: Array
    joint_at: Indices  # (J,)
    joint_place: Array  # (J, 3)
    joint_velocity: Array  # (J, 3) metres a frame, NaN where none is demanded
    joint_weight: Array
    joint_local: Array  # (J, F, 3) where the demanded joint is in the torso frame
    joint_step: Array  # (J, F, 3) its step to the next frame, in the torso frame
    style_from: Indices  # (S,)
    style_to: Indices
    style_weight: Array
    style_count: Indices  # (S, F + 1) frames so far that have the label
    avoid_kind: Indices  # (A,) 0 circle, 1 box
    avoid_shape: Array  # (A, 6) x, z, radius of a circle; low and high corners of a box
    avoid_weight: Array
    joints: npt.NDArray[np.float32]  # (F, K, 3) of every joint in the torso frame, or none
    reach: npt.NDArray[np.float32]  # (F,) how far over the floor the farthest joint is
    stops: Indices  # times up to which paths are compared while they grow, the last `frames`
    effort: Indices  # (4,) see `aim.Effort`
    locked: int  # nodes at the beginning of every path that may not change
    pose_at: Indices  # (H,)
    pose_clip: Indices
    pose_frame: Indices


class Trace(NamedTuple):
    """Where the pieces of a path lie and what it costs up to each: filled by scoring.

    A row a piece: turn, shift, first time, cost before it, demands met before it; `style` are the
    frames with each label so far.
    """

    turn: Complex
    shift: Complex
    time: npt.NDArray[np.int64]  # with one more, for the end
    total: Array
    met: npt.NDArray[np.int64]  # (MOST_NODES + 1, 3) of body, joint, pose
    style: Array


def new_trace(aim: Aim) -> Trace:
    """Room for the trace of one path."""
    rows = MOST_NODES + 1
    return Trace(
        np.zeros(rows, dtype=complex),
        np.zeros(rows, dtype=complex),
        np.zeros(rows, dtype=np.int64),
        np.zeros(rows),
        np.zeros((rows, 3), dtype=np.int64),
        np.zeros((rows, len(aim.style_from))),
    )


@compiled(nogil=True)
def score_path(
    space: Space, aim: Aim, path: Indices, count: int, frames: int, bound: float,
    begun: Trace, since: int, trace: Trace,
) -> tuple[float, int]:  # fmt: skip
    """S of a path of `count` nodes, infinite where it is none; and how many nodes the motion uses.

    Only its first `frames` count, and the demands on them. Scores above `bound` need not be exact.
    What comes before piece `since` is taken from the trace `begun` of a path that begins alike.
    """
    total, used = _pieces(space, aim, path, count, frames, bound, begun, since, trace)
    if total <= bound and len(aim.avoid_kind):
        for k in range(since):
            trace.turn[k], trace.shift[k] = begun.turn[k], begun.shift[k]
            trace.time[k] = begun.time[k]
        total += _avoided(space, aim, path, used, bound - total, trace)
    return total, used


@compiled(nogil=True)
def _pieces(
    space: Space, aim: Aim, path: Indices, count: int, frames: int, bound: float,
    begun: Trace, since: int, trace: Trace,
) -> tuple[float, int]:  # fmt: skip
    """All terms but those of places to avoid."""
    node = path[since]
    clip, j = space.node_to[node], space.node_j[node]
    styles = len(aim.style_from)
    if since == 0:
        at = space.first[clip] + j + 1
        turn = aim.body_turn[0] * np.conj(space.turn[at])
        shift = aim.body_place[0] - turn * space.place[at]
        time, total = 0, 0.0
        body, joint, pose = 1, 0, 0
        trace.style[0] = 0.0
    else:
        turn, shift = begun.turn[since], begun.shift[since]
        time, total = begun.time[since], begun.total[since]
        body, joint, pose = begun.met[since, 0], begun.met[since, 1], begun.met[since, 2]
        trace.style[since] = begun.style[since]
    for k in range(since, count):
        base = space.first[clip]
        last = k + 1 == count
        stop = space.frames[clip] - 1 if last else space.node_i[path[k + 1]]
        length = stop - j
        if length < 1 or (not last and space.node_from[path[k + 1]] != clip):
            return np.inf, count
        if time + length >= frames:
            length, last = frames - time, True
        if length < aim.shortest and (not last or (k > 0 and frames == aim.frames)):
            return np.inf, count
        trace.turn[k], trace.shift[k], trace.time[k], trace.total[k] = turn, shift, time, total
        trace.met[k] = (body, joint, pose)
        end = time + length
        until = frames if last else end
        hit, pose = _posed(aim, clip, j + 1 - time, until, pose)
        if not hit:
            return np.inf, count
        cost, body = _placed(space, aim, base, j + 1 - time, stop, until, body, turn, shift)
        total += cost
        while joint < len(aim.joint_at) and aim.joint_at[joint] < until:
            g = base + min(j + 1 + aim.joint_at[joint] - time, stop)
            total += _joint(space, aim, joint, g, turn, shift)
            joint += 1
        if styles:
            _styled(aim, base + j + 1 - time, time, end, trace, k)
        if total > bound:
            return total, k + 1
        time = end
        if last:
            total += aim.frames_weight * ((frames - end) / 10.0) ** 2
            for s in range(styles if frames == aim.frames else 0):
                lacking = aim.style_to[s] + 1 - aim.style_from[s] - trace.style[k + 1, s]
                total += aim.style_weight[s] * (lacking / 10.0) ** 2
            trace.time[k + 1] = time
            return total, k + 1
        node = path[k + 1]
        total += aim.cut_weight * space.node_cost[node]
        i, onto = base + space.node_i[node], space.node_to[node]
        j = space.node_j[node]
        g = space.first[onto] + j
        turned = turn * space.turn[i] * np.conj(space.turn[g])
        shift = shift + turn * space.place[i] - turned * space.place[g]
        turn, clip = turned, onto
    return np.inf, count


@inlined
def _posed(aim: Aim, clip: int, ahead: int, until: int, pose: int) -> tuple[bool, int]:
    """Whether a piece hits the poses demanded before `until`, and which pose is the next.

    Its clip's frame at time t is t + `ahead`; so it is below.
    """
    hit = True
    while pose < len(aim.pose_at) and aim.pose_at[pose] < until:
        hit &= clip == aim.pose_clip[pose] and aim.pose_at[pose] + ahead == aim.pose_frame[pose]
        pose += 1
    return hit, pose


@inlined
def _placed(
    space: Space, aim: Aim, base: int, ahead: int, stop: int, until: int, body: int,
    turn: complex, shift: complex,
) -> tuple[float, int]:  # fmt: skip
    """What the misses of the bodies demanded before `until` cost, and which body is the next."""
    cost = 0.0
    while body < len(aim.body_at) and aim.body_at[body] < until:
        g = base + min(aim.body_at[body] + ahead, stop)
        apart = shift + turn * space.place[g] - aim.body_place[body]
        facing = turn * space.turn[g] * np.conj(aim.body_turn[body])
        angle = np.arctan2(facing.imag, facing.real) / TEN_DEGREES
        far = (apart.real**2 + apart.imag**2) / 0.09
        cost += aim.body_weight[body] * (far + angle * angle)
        body += 1
    return cost, body


@compiled(nogil=True)
def _styled(aim: Aim, g: int, time: int, end: int, trace: Trace, k: int) -> None:
    """Counts the frames of piece k with each label; `g` is where its clip is at time 0."""
    for s in range(len(aim.style_from)):
        low, high = max(aim.style_from[s], time), min(aim.style_to[s] + 1, end)
        trace.style[k + 1, s] = trace.style[k, s]
        if low < high:
            trace.style[k + 1, s] += aim.style_count[s, g + high] - aim.style_count[s, g + low]


@compiled(nogil=True)
def _joint(space: Space, aim: Aim, joint: int, g: int, turn: complex, shift: complex) -> float:
    """What the miss of a joint's place, and of its velocity, costs."""
    local = aim.joint_local[joint, g]
    facing = turn * space.turn[g]
    over = shift + turn * space.place[g] + facing * complex(local[2], local[0])
    target = aim.joint_place[joint]
    far = (over.imag - target[0]) ** 2 + (local[1] - target[1]) ** 2 + (over.real - target[2]) ** 2
    velocity = aim.joint_velocity[joint]
    if not np.isnan(velocity[0]):
        step = aim.joint_step[joint, g]
        moved = facing * complex(step[2], step[0])
        apart = (moved.imag - velocity[0]) ** 2 + (step[1] - velocity[1]) ** 2
        apart += (moved.real - velocity[2]) ** 2
        far += 0.09 * 900.0 * apart  # a metre a second as thirty centimetres
    return aim.joint_weight[joint] * far / 0.09


@compiled(nogil=True)
def _avoided(space: Space, aim: Aim, path: Indices, used: int, bound: float, trace: Trace) -> float:
    """What frames cost in which a joint is where none may be: three like ten too many."""
    total = 0.0
    for a in range(len(aim.avoid_kind)):
        inside = 0
        for k in range(used):
            node = path[k]
            g = space.first[space.node_to[node]] + space.node_j[node] + 1
            for frame in range(trace.time[k + 1] - trace.time[k]):
                inside += _enters(space, aim, a, g + frame, trace.turn[k], trace.shift[k])
        total += aim.avoid_weight[a] * (inside / 3.0) ** 2
        if total > bound:
            break
    return total


@compiled(nogil=True)
def _enters(space: Space, aim: Aim, a: int, g: int, turn: complex, shift: complex) -> bool:
    """Whether any joint of a frame is in a place to avoid."""
    root = shift + turn * space.place[g]
    shape, reach = aim.avoid_shape[a], aim.reach[g]
    x, z = root.imag, root.real
    if aim.avoid_kind[a] == 0:
        if (x - shape[0]) ** 2 + (z - shape[1]) ** 2 > (shape[2] + reach) ** 2:
            return False
    elif not (shape[0] - reach < x < shape[3] + reach and shape[2] - reach < z < shape[5] + reach):
        return False
    facing = turn * space.turn[g]
    for k in range(aim.joints.shape[1]):
        local = aim.joints[g, k]
        over = root + facing * complex(local[2], local[0])
        x, z = over.imag, over.real
        if aim.avoid_kind[a] == 0:
            if (x - shape[0]) ** 2 + (z - shape[1]) ** 2 < shape[2] ** 2:
                return True
        elif shape[0] < x < shape[3] and shape[1] < local[1] < shape[4] and shape[2] < z < shape[5]:
            return True
    return False
