"""Measures of a transition: a motion that goes on has none to speak of; cuts have the most."""

import numpy as np

from stimuli.motion import Motion, forward
from stimuli.transition import transition, transition_measures
from stimuli.transition.measures import MEASURES


def test_a_motion_that_goes_on_differs_from_itself_in_nothing(bodies):
    a = bodies.wandering(60, 1)
    done = transition(a, a, 20, 28, frames=9)
    found = transition_measures(done, done)
    assert tuple(found) == MEASURES
    positions, _ = forward(a.skeleton, a.rotations, a.root)
    own = np.linalg.norm(np.diff(positions, 2, axis=0), axis=-1).max()
    assert found["velocity_jump"] <= own + 1e-9
    assert found["geodesic_cost"] < 1e-11
    assert found["displacement_from_reference"] == 0


def test_a_step_of_the_root_is_the_jump_of_velocity(bodies):
    still = bodies.standing(30)
    higher = Motion(still.skeleton, still.rotations, still.root + np.array([0.0, 0.2, 0.0]))
    done = transition(still, higher, 10, 15, method="cut")
    found = transition_measures(done)
    assert np.isclose(found["velocity_jump"], 0.2)
    assert np.isclose(found["acceleration_jump"], 0.4)
    assert found["displacement_from_reference"] is None
    assert found["foot_slide"] == 0.0


def test_displacement_is_the_mean_over_joints_and_mixed_frames(bodies):
    a, b = bodies.wandering(60, 1), bodies.wandering(60, 2)
    one, other = (transition(a, b, 20, 30, frames=n) for n in (5, 9))
    p, q = (forward(t.motion.skeleton, t.motion.rotations, t.motion.root)[0] for t in (one, other))
    expected = np.linalg.norm(p[20:29] - q[20:29], axis=-1).mean()
    assert np.isclose(transition_measures(one, other)["displacement_from_reference"], expected)


def test_a_longer_blend_is_smoother_at_its_ends(bodies):
    a, b = bodies.wandering(90, 3), bodies.wandering(90, 4)
    jumps = [
        transition_measures(transition(a, b, 30, 60, frames=n))["velocity_jump"] for n in (1, 30)
    ]
    cut = transition_measures(transition(a, b, 30, 60, method="cut"))["velocity_jump"]
    assert jumps[1] < jumps[0] < cut + 0.2


def test_a_skeleton_without_legs_has_no_slide(bodies):
    a = bodies.wandering(30, 1)
    roles = {k: v for k, v in a.skeleton.roles.items() if "ankle" not in k}
    bare = a.skeleton.__class__(
        a.skeleton.names, a.skeleton.parents, a.skeleton.offsets,
        a.skeleton.end_parents, a.skeleton.end_offsets, roles,
    )  # fmt: skip
    motion = Motion(bare, a.rotations, a.root)
    assert transition_measures(transition(motion, motion, 5, 9, frames=5))["foot_slide"] is None
