"""What tests of stimuli share: small bodies and motions whose answers are known."""

from types import MappingProxyType, SimpleNamespace

import numpy as np
import pytest

from stimuli.motion import Motion, Skeleton
from stimuli.motion import quaternions as quat
from stimuli.motion.formats.deepmimic import END_OFFSETS, END_PARENTS, JOINT_NAMES, OFFSETS, PARENTS
from stimuli.motion.roles import resolve_roles


def humanoid() -> Skeleton:
    """The fifteen-joint body of the sample motions; it faces +X in rest."""
    still = np.tile(quat.IDENTITY, (1, len(JOINT_NAMES), 1))
    roles = resolve_roles(JOINT_NAMES, PARENTS, still)
    return Skeleton(
        JOINT_NAMES, PARENTS, OFFSETS, END_PARENTS, END_OFFSETS, MappingProxyType(roles)
    )


def standing(frames: int = 1) -> Motion:
    """The humanoid in rest, facing +Z at the origin."""
    rotations = np.tile(quat.IDENTITY, (frames, len(JOINT_NAMES), 1))
    rotations[:, 0] = quat.about("Y", -np.pi / 2)
    root = np.tile([0.0, 0.89, 0.0], (frames, 1))
    return Motion(humanoid(), rotations, root)


def wandering(frames: int, seed: int, speed: float = 0.1) -> Motion:
    """A smooth random motion of every joint, turning and walking about."""
    rng = np.random.default_rng(seed)
    phase, rate = (
        rng.uniform(0, 6, (3, len(JOINT_NAMES))),
        rng.uniform(0.3, 1.0, (3, len(JOINT_NAMES))),
    )
    time = np.arange(frames)[:, None, None] * speed
    turns = (0.4 * np.sin(time * rate + phase)).transpose(0, 2, 1)
    rotations = quat.exp(turns)
    yaw = quat.about("Y", 0.02 * np.arange(frames) + rng.uniform(0, 6))
    rotations[:, 0] = quat.multiply(yaw, rotations[:, 0])
    path = np.cumsum(rng.normal(0.02, 0.002, (frames, 3)), axis=0)
    path[:, 1] = 0.9
    return Motion(humanoid(), rotations, path)


@pytest.fixture(scope="session")
def bodies() -> SimpleNamespace:
    """The functions `humanoid`, `standing` and `wandering`."""
    return SimpleNamespace(humanoid=humanoid, standing=standing, wandering=wandering)
