"""The two specifications to the letter, and what every method must leave as it is."""

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion import Motion
from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import headings, placed
from stimuli.transition import METHODS, SPECIFICATIONS, blend_length, longest_fitting, transition
from stimuli.transition.blend import smoothstep
from stimuli.transition.switch import decay_quintic, decay_spring
from stimuli.transition.window import center_aligned, start_end

SPECS = tuple(SPECIFICATIONS)


def test_start_end_joins_the_frames_of_the_definition():
    window = start_end(20, 60, 9)
    assert (window.first, window.last) == (20, 28)
    assert window.first + window.lag == 60 - 9 + 1
    assert window.last + window.lag == 60
    assert np.allclose(window.weights, np.arange(1, 10) / 10)


@pytest.mark.parametrize(("frames", "mixed"), [(1, 1), (2, 3), (3, 3), (10, 11), (11, 11)])
def test_center_aligned_mixes_b_or_b_plus_one_frames_around_the_instant(frames: int, mixed: int):
    window = center_aligned(20, 60, frames)
    assert window.last - window.first + 1 == mixed
    assert window.weights[20 - window.first] == 0.5
    steps = np.arange(window.first, window.last + 1) - 20
    assert np.allclose(window.weights, np.clip(0.5 + steps / (frames + 1), 0, 1))
    assert np.all((window.weights > 0) & (window.weights < 1))


@pytest.mark.parametrize("specification", SPECS)
def test_a_blend_is_slerp_and_linear_interpolation_of_the_frames_it_names(bodies, specification):
    a, b, i, j, frames = bodies.wandering(60, 1), bodies.wandering(70, 2), 20, 40, 9
    done = transition(a, b, i, j, frames=frames, specification=specification)
    window = SPECIFICATIONS[specification](i, j, frames)
    turn = headings(a)[i] - headings(b)[i + window.lag]
    moved = placed(b, turn, np.zeros(3))
    moved = placed(moved, 0.0, (a.root[i] - moved.root[i + window.lag]) * [1, 0, 1])
    for n, weight in zip(range(window.first, window.last + 1), window.weights, strict=True):
        for joint in range(len(a.skeleton)):
            p, q = a.rotations[n, joint], moved.rotations[n + window.lag, joint]
            expected = quat.slerp(p, q, weight)
            assert quat.geodesic(expected, done.motion.rotations[n, joint]) < 1e-7
        between = (1 - weight) * a.root[n] + weight * moved.root[n + window.lag]
        assert np.allclose(done.motion.root[n], between, atol=1e-12)
    assert np.array_equal(done.motion.rotations[: window.first], a.rotations[: window.first])
    after = done.motion.root[window.last + 1 :]
    assert np.allclose(after, moved.root[window.last + window.lag + 1 :], atol=1e-12)
    assert done.mixed == (window.first, window.last)


def test_a_cut_goes_from_frame_i_to_frame_j_plus_one(bodies):
    a, b = bodies.wandering(30, 1), bodies.wandering(40, 2)
    done = transition(a, b, 12, 25, method="cut")
    assert len(done.motion) == 13 + 40 - 26
    assert np.array_equal(done.motion.rotations[:13], a.rotations[:13])
    assert np.allclose(done.motion.rotations[13:, 1:], b.rotations[26:, 1:])
    assert (done.frames, done.mixed) == (0, (12, 12))
    with pytest.raises(InputError, match="cut"):
        transition(a, b, 12, 25, method="cut", frames=3)


@pytest.mark.parametrize("specification", SPECS)
@pytest.mark.parametrize("method", [m for m in METHODS if m != "dead-blending"])
def test_a_motion_joined_to_itself_where_it_continues_stays_itself(bodies, method, specification):
    a, i = bodies.wandering(90, 3), 30
    for frames in (1, 4, 9, 20):
        j = i + frames - 1 if specification == "start-end" and method != "cut" else i
        given = None if method == "cut" else frames
        done = transition(a, a, i, j, method=method, specification=specification, frames=given)
        assert len(done.motion) == len(a)
        assert np.abs(done.motion.rotations - a.rotations).max() < 1e-6
        assert np.abs(done.motion.root - a.root).max() < 1e-6


@pytest.mark.parametrize("specification", SPECS)
def test_dead_blending_deviates_by_what_it_extrapolates_and_no_more(bodies, specification):
    a = bodies.wandering(90, 3, speed=0.05)
    j = 38 if specification == "start-end" else 30
    done = transition(a, a, 30, j, method="dead-blending", specification=specification, frames=9)
    apart = quat.geodesic(done.motion.rotations, a.rotations)
    assert 0 < apart.max() < 0.1
    first, last = done.mixed
    assert np.all(apart[:first] == 0)
    assert apart[last + 1 :].max() < 1e-7


@pytest.mark.parametrize("method", list(METHODS))
@pytest.mark.parametrize("specification", SPECS)
def test_every_method_joins_two_motions_and_says_what_it_mixed(bodies, method, specification):
    a, b = bodies.wandering(130, 4), bodies.wandering(130, 5)
    done = transition(a, b, 62, 66, method=method, specification=specification, smooth=True)
    first, last = done.mixed
    motion = done.motion
    norms = np.linalg.norm(motion.rotations, axis=-1)
    assert np.allclose(norms, 1.0, atol=1e-9)
    assert np.allclose(motion.rotations[:first], a.rotations[:first])
    tail = len(motion) - last - 1
    assert np.allclose(motion.rotations[last + 1 :, 1:], b.rotations[len(b) - tail :, 1:])
    assert done.frames == blend_length(a, b, 62, 66, method, specification).frames


def test_inertialization_starts_on_a_with_its_velocity_and_settles_on_b(bodies):
    a, b = bodies.wandering(60, 6), bodies.wandering(80, 7)
    for method in ("inertialization", "inertialization-spring"):
        done = transition(a, b, 25, 40, method=method, frames=12)
        assert quat.geodesic(done.motion.rotations[25], a.rotations[25]).max() < 1e-7
        assert np.allclose(done.motion.rotations[37:, 1:], b.rotations[41:, 1:])


def test_the_quintic_starts_with_the_speed_it_is_given_and_ends_at_rest():
    path = decay_quintic(np.array([1.0]), np.array([0.05]), 400)[:, 0]
    assert np.isclose(path[0], 1.0)
    assert np.isclose(path[1] - path[0], 0.05, atol=1e-4)
    assert np.abs(np.diff(path, 2)[:2]).max() < 1e-4
    assert abs(path[-1]) < 1e-5
    spring = decay_spring(np.array([1.0]), np.array([0.05]), 400)[:, 0]
    assert np.isclose(spring[1] - spring[0], 0.05, atol=2e-3)
    assert abs(spring[-1]) < 0.02


def test_the_sigmoid_has_the_ends_and_the_middle_of_the_line():
    assert np.allclose(smoothstep(np.array([0.0, 0.5, 1.0])), [0.0, 0.5, 1.0])


def test_b_takes_the_skeleton_of_a_and_its_root_the_ratio_of_the_legs(bodies):
    a, b = bodies.wandering(40, 1), bodies.wandering(40, 2)
    taller = a.skeleton.__class__(
        a.skeleton.names, a.skeleton.parents, a.skeleton.offsets * 1.2,
        a.skeleton.end_parents, a.skeleton.end_offsets, a.skeleton.roles,
    )  # fmt: skip
    done = transition(Motion(taller, a.rotations, a.root), b, 10, 20, frames=5)
    assert done.motion.skeleton is taller
    assert np.allclose(done.motion.root[20:, 1], b.root[26:, 1] * 1.2)


def test_what_cannot_be_joined_is_refused_by_name(bodies):
    a, b = bodies.wandering(40, 1), bodies.wandering(40, 2)
    other = a.skeleton.__class__(
        ("hips", *a.skeleton.names[1:]), a.skeleton.parents, a.skeleton.offsets,
        a.skeleton.end_parents, a.skeleton.end_offsets, a.skeleton.roles,
    )  # fmt: skip
    refused = [
        ({"i": 10, "j": 20, "frames": 25}, "from 1 to 21"),
        ({"i": 40, "j": 20}, "0 to 39"),
        ({"i": 10, "j": -1}, "0 to 39"),
        ({"i": 10, "j": 20, "method": "magic"}, "inertialization"),
        ({"i": 10, "j": 20, "specification": "middle"}, "center-aligned"),
        ({"i": 10, "j": 20, "frames": 0}, "from 1"),
    ]
    for arguments, told in refused:
        i, j = arguments.pop("i"), arguments.pop("j")
        with pytest.raises(InputError, match=told):
            transition(a, b, i, j, **arguments)
    with pytest.raises(InputError, match="hierarchy"):
        transition(a, Motion(other, b.rotations, b.root), 10, 20)
    nameless = a.skeleton.__class__(*(getattr(a.skeleton, name) for name in (
        "names", "parents", "offsets", "end_parents", "end_offsets")))  # fmt: skip
    with pytest.raises(InputError, match="left_hip"):
        transition(
            Motion(nameless, a.rotations, a.root), Motion(nameless, b.rotations, b.root), 9, 20
        )


def test_the_longest_fitting_length(bodies):
    a, b = bodies.wandering(40, 1), bodies.wandering(40, 2)
    assert longest_fitting(a, b, 30, 35, "start-end") == 10
    assert longest_fitting(a, b, 5, 35, "start-end") == 35
    assert longest_fitting(a, b, 5, 20, "center-aligned") == 11
