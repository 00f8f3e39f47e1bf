"""A hierarchy of joints and a motion of it: frozen, and all that the rest of Segue works on."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType

import numpy as np

from stimuli.errors import InputError
from stimuli.motion.quaternions import Array

Level = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Joints in rest: parents come before children, one root (parent −1), offsets in metres.

    `roles` gives the joint that plays an anatomical part ("left_knee": the joint whose rotation
    moves the left shank). End sites are points without rotation: fingertips, toes, head top.
    """

    names: tuple[str, ...]
    parents: np.ndarray  # (J,) int
    offsets: Array  # (J, 3) from the parent, in the parent's frame; the root's is zero
    end_parents: np.ndarray  # (E,) int
    end_offsets: Array  # (E, 3)
    roles: Mapping[str, int] = field(default_factory=lambda: MappingProxyType({}))

    def __len__(self) -> int:
        return len(self.names)

    @cached_property
    def levels(self) -> tuple[Level, ...]:
        """Joints below the root by depth, each level as (joints, their parents)."""
        depth = np.zeros(len(self.parents), dtype=int)
        for joint, parent in enumerate(self.parents):
            depth[joint] = 0 if parent < 0 else depth[parent] + 1
        joints = (np.flatnonzero(depth == level) for level in range(1, int(depth.max()) + 1))
        return tuple((level, self.parents[level]) for level in joints)

    def chain(self, joint: int) -> list[int]:
        """Joints from the root to `joint`, both included."""
        path = []
        while joint >= 0:
            path.append(joint)
            joint = int(self.parents[joint])
        return path[::-1]

    def role(self, *roles: str) -> list[int]:
        """The joints that play `roles`; InputError naming those that no joint plays."""
        if missing := [role for role in roles if role not in self.roles]:
            raise InputError(
                f"skeleton of {self.names[0]} ({len(self)} joints): no joint plays "
                f"{', '.join(missing)}.\nName them in an overrides file, as role = joint."
            )
        return [self.roles[role] for role in roles]

    def same_hierarchy(self, other: "Skeleton") -> bool:
        """Whether joints have the same names and parents in the same order."""
        return self.names == other.names and np.array_equal(self.parents, other.parents)

    def same_as(self, other: "Skeleton") -> bool:
        """Whether nothing tells the two apart: hierarchy, bones, end sites and roles."""
        return self is other or (
            self.same_hierarchy(other)
            and np.array_equal(self.offsets, other.offsets)
            and np.array_equal(self.end_parents, other.end_parents)
            and np.array_equal(self.end_offsets, other.end_offsets)
            and self.roles == other.roles
        )


def children_of(parents: np.ndarray) -> list[list[int]]:
    """The joints that hang on each joint, in their own order."""
    children: list[list[int]] = [[] for _ in parents]
    for joint, parent in enumerate(parents):
        if parent >= 0:
            children[parent].append(joint)
    return children


def depth_first_order(parents: np.ndarray) -> list[int]:
    """Joints as a nested hierarchy lists them: each, then all that hangs on it."""
    children = children_of(parents)
    order, waiting = [], [0]
    while waiting:
        joint = waiting.pop()
        order.append(joint)
        waiting += reversed(children[joint])
    return order


@dataclass(frozen=True, eq=False)
class Cycle:
    """One closed cycle of a loop: its last pose is its first, turned and moved on the floor.

    Poses (N, J, 4) and (N, 3) at even steps over `period` frames of the motion; the next cycle is
    this one turned by `yaw` (radians about +Y) around the origin, then moved by `shift` (3,).
    """

    period: float
    yaw: float
    shift: Array
    rotations: Array
    root: Array

    def same_as(self, other: "Cycle") -> bool:
        """Whether nothing tells the two apart."""
        return self is other or (
            (self.period, self.yaw) == (other.period, other.yaw)
            and np.array_equal(self.shift, other.shift)
            and np.array_equal(self.root, other.root)
            and np.array_equal(self.rotations, other.rotations)
        )


@dataclass(frozen=True, eq=False)
class Motion:
    """Local joint rotations (F, J, 4) as unit quaternions and root positions (F, 3) in metres."""

    skeleton: Skeleton
    rotations: Array
    root: Array
    fps: float = 30.0
    cycle: Cycle | None = None

    @property
    def loop(self) -> bool:
        """Whether the motion is one cycle of a loop."""
        return self.cycle is not None

    def __len__(self) -> int:
        return len(self.rotations)

    def __getitem__(self, frames: slice) -> "Motion":
        """Some of the frames; a part of a loop is no loop."""
        return Motion(self.skeleton, self.rotations[frames], self.root[frames], self.fps)

    def same_as(self, other: "Motion") -> bool:
        """Whether nothing tells the two apart, as when one file was read twice.

        Most pairs differ in length or in where the root stands, which is asked first.
        """
        if self is other:
            return True
        if len(self) != len(other) or self.fps != other.fps or self.loop != other.loop:
            return False
        return (
            np.array_equal(self.root[:1], other.root[:1])
            and np.array_equal(self.root, other.root)
            and self.skeleton.same_as(other.skeleton)
            and np.array_equal(self.rotations, other.rotations)
            and (self.cycle is None or other.cycle is None or self.cycle.same_as(other.cycle))
        )

    @property
    def seconds(self) -> float:
        """From the first frame to the last."""
        return (len(self) - 1) / self.fps
