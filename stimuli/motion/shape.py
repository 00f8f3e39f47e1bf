"""Which joint plays which anatomical part, told from the shape of a skeleton where names do not.

A body has two pairs of limbs that are alike on either side: legs, the longer, and arms. The two
longest bones in a row of a limb are thigh and shank, or upper arm and forearm. Between the pairs
lies the trunk; what else hangs on its upper end is the neck. Which leg is the left one follows from
where the feet point in rest or, where the rest pose does not stand, in the first frame; which arm,
from which leg it is above as the body moves.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.motion.roles import ROLES, chain_to, trunk_roles
from stimuli.motion.skeleton import Skeleton, children_of

_ALIKE = 0.1  # limbs whose lengths differ by less, in proportion, are a pair
_EVEN = 0.4  # of two bones in a row, the shorter is at least so much of the longer
_SHORTER = 0.8  # of a clavicle and an upper arm, as much as the arm itself has at the least
_MOST_FRAMES = 50  # that are asked for the side of an arm
_PARTS = {"leg": ("hip", "knee", "ankle", "toe"), "arm": ("shoulder", "elbow", "wrist")}


@dataclass(frozen=True)
class _Pair:
    """Two limbs alike that part at a joint, each as the joints of its longest chain."""

    parting: int
    limbs: tuple[tuple[int, ...], tuple[int, ...]]
    length: float


def shape_roles(skeleton: Skeleton, rotations: Array, known: Mapping[str, int]) -> dict[str, int]:
    """Role → joint for the roles that `known` lacks, as far as the shape shows them.

    `rotations` (F, J, 4) are of the skeleton; its own roles are not asked.
    """
    tree = _Tree(skeleton)
    pairs = _two_pairs(tree)
    if pairs is None:
        return {}
    legs, arms = pairs
    found = _limbs(tree, legs, "leg") | _limbs(tree, arms, "arm") | _head(tree, legs, arms)
    found = _sided(skeleton, rotations, found, known)
    found |= trunk_roles(found | dict(known), skeleton.parents, rotations)
    taken = set(known.values())
    fitting = {r: j for r, j in found.items() if r not in known and j not in taken}
    fitting = {r: j for r, j in fitting.items() if _in_order(skeleton.parents, r, j, known)}
    return {role: fitting[role] for role in ROLES if role in fitting}


class _Tree:
    """Children, bone lengths, and how far each joint's longest chain reaches below it."""

    def __init__(self, skeleton: Skeleton) -> None:
        self.parents = skeleton.parents
        self.children = children_of(skeleton.parents)
        self.lengths = quat.norm(skeleton.offsets)
        self.tips = np.zeros(len(skeleton))
        for parent, far in zip(
            skeleton.end_parents, quat.norm(skeleton.end_offsets.reshape(-1, 3)), strict=True
        ):
            self.tips[parent] = max(self.tips[parent], far)
        self.reach = self.tips.copy()
        for joint in range(len(skeleton) - 1, 0, -1):
            parent = skeleton.parents[joint]
            self.reach[parent] = max(self.reach[parent], self.limb(joint))

    def limb(self, joint: int) -> float:
        """From the joint above to the end of the longest chain."""
        return float(self.lengths[joint] + self.reach[joint])

    def chain(self, joint: int) -> tuple[int, ...]:
        """The longest chain that begins with a joint."""
        chain = [joint]
        while self.children[chain[-1]]:
            chain.append(max(self.children[chain[-1]], key=self.limb))
        return tuple(chain)


def _two_pairs(tree: _Tree) -> tuple[_Pair, _Pair] | None:
    """Legs and arms: the two longest pairs, neither within a limb of the other."""
    chosen: list[_Pair] = []
    for pair in sorted(_pairs(tree), key=lambda pair: -pair.length):
        if not any(_within(tree, pair, other) or _within(tree, other, pair) for other in chosen):
            chosen.append(pair)
        if len(chosen) == 2:
            break
    if len(chosen) < 2:
        return None
    spans = [_span(tree, pair.limbs[0]) for pair in chosen]
    if spans[0] is None or spans[1] is None or chosen[0].parting == chosen[1].parting:
        return None
    first, second = chosen
    return (first, second) if spans[0][1] > spans[1][1] else (second, first)


def _within(tree: _Tree, pair: _Pair, other: _Pair) -> bool:
    """Whether a pair parts within a limb of another, or is that other's limb."""
    above = chain_to(tree.parents, pair.parting) + [limb[0] for limb in pair.limbs]
    return any(limb[0] in above for limb in other.limbs)


def _pairs(tree: _Tree) -> Iterator[_Pair]:
    """At each joint the two limbs that are most alike, if they are alike enough."""
    for joint, children in enumerate(tree.children):
        best: tuple[float, int, int] | None = None
        for place, one in enumerate(children):
            for other in children[place + 1 :]:
                longer = max(tree.limb(one), tree.limb(other))
                apart = abs(tree.limb(one) - tree.limb(other)) / longer if longer else 1.0
                chains = tree.chain(one), tree.chain(other)
                same = abs(len(chains[0]) - len(chains[1])) <= 1
                if same and None not in [_span(tree, chain) for chain in chains] and apart < _ALIKE:
                    best = min(best or (apart, one, other), (apart, one, other))
        if best is not None:
            limbs = tree.chain(best[1]), tree.chain(best[2])
            yield _Pair(joint, limbs, max(map(tree.limb, best[1:])))


def _span(tree: _Tree, chain: tuple[int, ...]) -> tuple[int, float] | None:
    """Where in a limb its two long bones begin, and how long they are together.

    Of all two bones in a row that are about even: the two that are longest. But where these are the
    first two and the next two are hardly shorter, the first is a clavicle.
    """
    bones = [*(float(tree.lengths[joint]) for joint in chain[1:]), float(tree.tips[chain[-1]])]
    spans = {
        place: one + other
        for place, (one, other) in enumerate(pairwise(bones))
        if min(one, other) > _EVEN * max(one, other)
    }
    if not spans:
        return None
    place = max(spans, key=lambda place: spans[place])
    within = 1 in spans and len(bones) > 3  # the second two end at a joint
    if place == 0 and within and spans[1] > _SHORTER * spans[0]:
        place = 1
    return place, spans[place]


def _limbs(tree: _Tree, pair: _Pair, kind: str) -> dict[str, int]:
    """The roles of a pair's joints, its first limb taken as the left one."""
    roles: dict[str, int] = {}
    for side, limb in zip(("left", "right"), pair.limbs, strict=True):
        span = _span(tree, limb)
        if span is None:
            continue
        roles |= {
            f"{side}_{part}": joint
            for part, joint in zip(_PARTS[kind], limb[span[0] :], strict=False)
        }
        if kind == "arm" and span[0]:
            roles[f"{side}_clavicle"] = limb[span[0] - 1]
    return roles


def _head(tree: _Tree, legs: _Pair, arms: _Pair) -> dict[str, int]:
    """Neck and head: the longest chain at the arms that leads neither into them nor to the legs."""
    arm_roots = {limb[0] for limb in arms.limbs}
    toward_legs = set(chain_to(tree.parents, legs.parting))
    free = [
        joint for joint in tree.children[arms.parting]
        if joint not in arm_roots and joint not in toward_legs
    ]  # fmt: skip
    if not free:
        return {}
    chain = list(tree.chain(max(free, key=tree.limb)))
    for place, joint in enumerate(chain[1:], start=1):
        if len(tree.children[joint]) > 1:  # eyes and jaw
            chain = chain[: place + 1]
            break
    top = chain[-1]
    if len(chain) > 2 and tree.reach[top] == 0 and tree.lengths[top] > tree.lengths[chain[-2]]:
        chain.pop()  # the top of the head as a joint
    return {"neck": chain[0], "head": chain[-1]} if len(chain) > 1 else {"head": chain[0]}


def _sided(
    skeleton: Skeleton, rotations: Array, found: dict[str, int], known: Mapping[str, int]
) -> dict[str, int]:
    """The roles with left and right as the names have them, or else as the body faces.

    Arms are on the side of the legs below them. Where nothing tells, no role that has a side.
    """
    legs, arms = (_agreement(found, known, kind) for kind in ("hip", "shoulder"))
    if not legs and {"left_ankle", "right_ankle", "head"} <= found.keys():
        legs = 1 if _faces(skeleton, rotations, found) else -1
    if legs < 0:
        found = found | _swapped(found, "hip")
    if not arms and legs and "left_shoulder" in found:
        arms = 1 if _above(skeleton, rotations, found) else -1
    if arms < 0:
        found = found | _swapped(found, "shoulder")
    untold = {*([] if legs else _LIMBS_OF["hip"]), *([] if arms else _LIMBS_OF["shoulder"])}
    return {role: joint for role, joint in found.items() if role.split("_")[-1] not in untold}


def _agreement(found: Mapping[str, int], known: Mapping[str, int], kind: str) -> int:
    """Above 0 if names have the legs or arms on the sides found, below if on the others."""
    roles = [role for role in found if role.split("_")[-1] in _LIMBS_OF[kind]]
    agree = sum(known.get(role) == found[role] for role in roles)
    return agree - sum(known.get(_other_side(role)) == found[role] for role in roles)


def _swapped(found: Mapping[str, int], kind: str) -> dict[str, int]:
    """The roles of legs or arms with left and right changed."""
    return {_other_side(r): j for r, j in found.items() if r.split("_")[-1] in _LIMBS_OF[kind]}


def _above(skeleton: Skeleton, rotations: Array, roles: Mapping[str, int]) -> bool:
    """Whether the left arm is above the left leg, in most of some frames."""
    from stimuli.motion.kinematics import forward

    some = rotations[:: max(1, len(rotations) // _MOST_FRAMES)]
    places, _ = forward(skeleton, some, np.zeros((len(some), 3)))
    hips, shoulders = (
        places[:, roles[f"left_{part}"]] - places[:, roles[f"right_{part}"]]
        for part in ("hip", "shoulder")
    )
    return bool(np.sum(np.sign(np.vecdot(hips, shoulders))) >= 0)


_LIMBS_OF = {
    "hip": ("hip", "knee", "ankle", "toe"),
    "shoulder": ("clavicle", "shoulder", "elbow", "wrist"),
}


def _other_side(role: str) -> str:
    side, _, part = role.partition("_")
    return f"{ {'left': 'right', 'right': 'left'}[side] }_{part}" if part else role


def _faces(skeleton: Skeleton, rotations: Array, roles: Mapping[str, int]) -> bool:
    """Whether the leg called left is on the left of a body that looks where its feet point."""
    from stimuli.motion.kinematics import end_positions, forward

    still = np.tile(quat.IDENTITY, (len(skeleton), 1))
    for pose in (still, rotations[0]):
        places, turns = forward(skeleton, pose, np.zeros(3))
        ankles = [roles["left_ankle"], roles["right_ankle"]]
        rise = places[roles["head"]] - places[ankles].mean(axis=0)
        if np.linalg.norm(rise) > 0.5 * _height(skeleton, roles):
            break
    up = rise / np.linalg.norm(rise)
    ends = end_positions(skeleton, places, turns)
    toes = [
        np.concatenate([places[skeleton.parents == foot], ends[skeleton.end_parents == foot]])
        for foot in ankles
    ]
    ahead = sum(
        (
            toe.mean(axis=0) - places[foot]
            for toe, foot in zip(toes, ankles, strict=True)
            if len(toe)
        ),
        np.zeros(3),
    )
    left = quat.cross(up, ahead - up * (up @ ahead))
    if np.linalg.norm(left) < 0.01 * _height(skeleton, roles):
        left = np.array([1.0, 0.0, 0.0])  # no feet to be seen: it faces +Z, as most do in rest
    across = places[roles["left_hip"]] - places[roles["right_hip"]]
    return bool(across @ left > 0)


def _height(skeleton: Skeleton, roles: Mapping[str, int]) -> float:
    """Bone lengths from the root to the head and to an ankle."""
    lengths = quat.norm(skeleton.offsets)
    return float(sum(lengths[skeleton.chain(roles[role])].sum() for role in ("head", "left_ankle")))


def _in_order(parents: np.ndarray, role: str, joint: int, known: Mapping[str, int]) -> bool:
    """Whether a joint lies in its limb where the joints that names tell leave it room."""
    side, _, part = role.partition("_")
    for parts in _LIMBS_OF.values():
        if part not in parts:
            continue
        for other in parts:
            there = known.get(f"{side}_{other}")
            if there is None:
                continue
            first, last = (
                (there, joint) if parts.index(other) < parts.index(part) else (joint, there)
            )
            if first not in chain_to(parents, last):
                return False
    return True
