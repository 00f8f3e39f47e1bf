"""A path told in words and numbers: its pieces, every term of its score, every miss.

All is reckoned anew from the clips, in plain NumPy: what the compiled search says is checked by it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stimuli.collection import Collection, floor_frames
from stimuli.graph.aim import aim_at
from stimuli.graph.demands import Demand, Demands
from stimuli.graph.score_loop import Aim
from stimuli.motion.quaternions import Array


@dataclass(frozen=True)
class Stretch:
    """Frames `first` to `last` of a clip, both played; `cost` is of the cut into it."""

    clip: int
    first: int
    last: int
    cost: float = 0.0

    def __len__(self) -> int:
        return self.last - self.first + 1


@dataclass(frozen=True, eq=False)
class MotionPlan:
    """A motion that was found for demands: its pieces, its score term by term, its misses."""

    demands: Demands
    pieces: tuple[Stretch, ...]
    terms: Mapping[str, float]
    misses: tuple[str, ...]
    place: Array  # (T, 2) x, z on the floor of every frame, before anything is smoothed
    yaw: Array  # (T,)

    @property
    def score(self) -> float:
        """S, the sum of all terms."""
        return float(sum(self.terms.values()))

    @property
    def frames(self) -> int:
        """How many frames the motion has."""
        return len(self.yaw)


def motion_plan(demands: Demands, pieces: Sequence[Stretch], collection: Collection) -> MotionPlan:
    """The plan of some pieces: where the body goes, and what it costs (eq. 1)."""
    aim = aim_at(demands, collection)
    place, yaw, rows = _laid_out(aim, pieces, collection)
    terms = {
        "cuts": aim.cut_weight * sum(piece.cost for piece in pieces[1:]),
        "frames": aim.frames_weight * ((aim.frames - len(yaw)) / 10.0) ** 2,
    }
    misses = []
    missing = aim.frames - len(yaw)
    if missing:
        misses.append(f"frames: {missing} of {aim.frames} missing")
    for kind, told in (
        ("body", _body), ("joint", _joint), ("style", _style), ("avoid", _avoid), ("pose", _pose)
    ):  # fmt: skip
        for n, demand in enumerate(demands.of(kind)):
            term, words = told(aim, n, demand, place, yaw, rows)
            if kind != "pose":
                terms[f"{kind} {n + 1}"] = term
            misses.append(f"{kind} {n + 1}: {words}")
    return MotionPlan(demands, tuple(pieces), terms, tuple(misses), place, yaw)


def _laid_out(
    aim: Aim, pieces: Sequence[Stretch], collection: Collection
) -> tuple[Array, Array, np.ndarray]:
    """Place (T, 2) and heading (T,) of every frame, and which frame of all (T,) each is."""
    places, turns, rows = [], [], []
    end_turn, end_place = aim.body_turn[0], aim.body_place[0]
    for n, piece in enumerate(pieces):
        floor = floor_frames(collection.motions[piece.clip])
        z = floor.place[:, 1] + 1j * floor.place[:, 0]
        facing = np.exp(1j * floor.yaw)
        onto = piece.first - 1 if n else piece.first
        turn = end_turn * np.conj(facing[onto])
        shift = end_place - turn * z[onto]
        part = slice(piece.first, piece.last + 1)
        places.append(shift + turn * z[part])
        turns.append(turn * facing[part])
        rows.append(int(collection.starts[piece.clip]) + np.arange(piece.first, piece.last + 1))
        end_turn, end_place = turns[-1][-1], places[-1][-1]
    over = np.concatenate(places)
    return (
        np.stack([over.imag, over.real], axis=1),
        np.angle(np.concatenate(turns)),
        np.concatenate(rows),
    )


def _body(
    aim: Aim, n: int, demand: Demand, place: Array, yaw: Array, rows: np.ndarray
) -> tuple[float, str]:
    at = min(demand["at"], len(yaw) - 1)
    apart = place[at] - np.array(demand["place"], dtype=float)
    angle = _turned(np.degrees(yaw[at]) - demand["heading"])
    far = float(np.hypot(*apart))
    term = float(aim.body_weight[n] * ((far / 0.3) ** 2 + (angle / 10.0) ** 2)) if n else 0.0
    return term, f"at {demand['at']}: {_metres(far)} and {abs(angle):.1f}° off"


def _turned(degrees: float) -> float:
    return float((degrees + 180.0) % 360.0 - 180.0)


def _metres(far: float) -> str:
    return f"{far:.2f} m" if far >= 1 else f"{100 * far:.0f} cm"


def _in_world(local: Array, place: Array, yaw: float) -> Array:
    """A point or a step in the torso frame, in the world: turned, and moved to a place."""
    s, c = np.sin(yaw), np.cos(yaw)
    x = place[0] + c * local[..., 0] + s * local[..., 2]
    z = place[1] - s * local[..., 0] + c * local[..., 2]
    return np.stack([x, local[..., 1], z], axis=-1)


def _joint(
    aim: Aim, n: int, demand: Demand, place: Array, yaw: Array, rows: np.ndarray
) -> tuple[float, str]:
    at = min(demand["at"], len(yaw) - 1)
    there = _in_world(aim.joint_local[n, rows[at]], place[at], float(yaw[at]))
    far = float(np.linalg.norm(there - aim.joint_place[n]))
    squares, words = far**2, f"{demand['role']} {_metres(far)} off"
    if demand["velocity"] is not None:
        step = _in_world(aim.joint_step[n, rows[at]], np.zeros(2), float(yaw[at]))
        apart = 30.0 * float(np.linalg.norm(step - aim.joint_velocity[n]))
        squares += 0.09 * apart**2
        words += f", its velocity {apart:.2f} m/s"
    return float(aim.joint_weight[n] * squares / 0.09), f"at {demand['at']}: {words}"


def _style(
    aim: Aim, n: int, demand: Demand, place: Array, yaw: Array, rows: np.ndarray
) -> tuple[float, str]:
    span = rows[demand["from"] : demand["to"] + 1]
    wanted = demand["to"] - demand["from"] + 1
    has = int((aim.style_count[n, span + 1] - aim.style_count[n, span]).sum())
    term = float(aim.style_weight[n] * ((wanted - has) / 10.0) ** 2)
    words = f"{wanted - has} of {wanted} frames are no {demand['label']}"
    return term, f"from {demand['from']} to {demand['to']}: {words}"


def _avoid(
    aim: Aim, n: int, demand: Demand, place: Array, yaw: Array, rows: np.ndarray
) -> tuple[float, str]:
    inside = 0
    shape = aim.avoid_shape[n]
    for at, row in enumerate(rows):
        joints = _in_world(aim.joints[row].astype(float), place[at], float(yaw[at]))
        if demand["centre"]:
            apart = np.hypot(joints[:, 0] - shape[0], joints[:, 2] - shape[1])
            inside += bool((apart < shape[2]).any())
        else:
            inside += bool(((joints > shape[:3]) & (joints < shape[3:])).all(axis=1).any())
    told = f"entered for {inside} frames" if inside else "not entered"
    return float(aim.avoid_weight[n] * (inside / 3.0) ** 2), told


def _pose(
    aim: Aim, n: int, demand: Demand, place: Array, yaw: Array, rows: np.ndarray
) -> tuple[float, str]:
    return 0.0, f"at {demand['at']}: {demand['clip']}:{demand['frame']} hit"


def plan_document(plan: MotionPlan, names: Sequence[str], **more: Any) -> dict[str, Any]:
    """A plan as JSON has it."""
    return {
        "figure": plan.demands.name,
        "score": plan.score,
        "frames": plan.frames,
        "terms": dict(plan.terms),
        "misses": list(plan.misses),
        "pieces": [
            {"clip": names[p.clip], "from_frame": p.first, "to_frame": p.last, "cut_cost": p.cost}
            for p in plan.pieces
        ],
        "demands": [{"kind": demand.kind, **demand.values} for demand in plan.demands.demands],
        **more,
    }
