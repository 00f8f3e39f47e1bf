"""Feet that roll no further than asked for, and are left alone where they do not."""

from dataclasses import replace

import numpy as np

from stimuli.motion import Motion, forward, walker
from stimuli.motion import quaternions as quat
from stimuli.render import Appearance
from stimuli.render.bodies import make_body, rig_motion
from stimuli.render.feet import foot_roll, limited_roll


def rolled(degrees: float) -> Motion:
    """A walk whose left foot is rolled about its own axis."""
    motion = walker(0)
    body = make_body(motion, Appearance(style="stick"))
    _, orientations = forward(motion.skeleton, motion.rotations, motion.root)
    _, axis = foot_roll(body.rig, orientations, "left")
    (ankle,) = motion.skeleton.role("left_ankle")
    turn = np.radians(degrees) / 2
    rest = body.rig.reference.orientations[ankle]
    local = quat.rotate(quat.inverse(rest), axis)
    rotations = motion.rotations.copy()
    rotations[:, ankle] = quat.multiply(
        rotations[:, ankle], np.concatenate([[np.cos(turn)], np.sin(turn) * local])
    )
    return replace(motion, rotations=rotations)


def rolls(motion: Motion, limit: float | None) -> np.ndarray:
    """Degrees that the left foot is rolled in each frame, limited or not."""
    body = make_body(walker(0), Appearance(style="stick"))
    positions, orientations = forward(motion.skeleton, motion.rotations, motion.root)
    if limit is not None:
        positions, orientations = limited_roll(body.rig, positions, orientations, np.radians(limit))
    return np.degrees(foot_roll(body.rig, orientations, "left")[0])


def test_a_rolled_foot_is_brought_within_the_limit() -> None:
    motion = rolled(120.0)
    assert np.median(rolls(motion, None)) > 90
    assert np.abs(rolls(motion, 25.0)).max() < 25 + 1e-6


def test_what_lies_within_the_limit_stays_as_it_is() -> None:
    motion = rolled(10.0)
    np.testing.assert_allclose(rolls(motion, 60.0), rolls(motion, None), atol=1e-6)


def test_toes_go_with_the_foot_and_the_rest_stays() -> None:
    motion = rolled(120.0)
    body = make_body(walker(0), Appearance(style="stick"))
    limited = make_body(walker(0), Appearance(style="stick", foot_roll=25.0))
    names = body.rig.names
    before, after = (rig_motion(b, motion) for b in (body, limited))
    changed = {
        name for k, name in enumerate(names) if np.abs(before[:, k] - after[:, k]).max() > 1e-6
    }
    assert changed <= {"left_ankle", "left_toe"}
    assert "left_ankle" in changed
