"""The two specifications to the letter, and what every method must leave as it is."""

import re
from contextlib import suppress

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion import Motion
from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import headings, placed
from stimuli.transition import (
    PAIRWISE,
    SPECIFICATIONS,
    Transition,
    blend_length,
    longest_fitting,
    transition,
    transition_measures,
)
from stimuli.transition.blend import smoothstep
from stimuli.transition.timewarp import timewarp_costs
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
@pytest.mark.parametrize("method", [m for m in PAIRWISE if m != "dead-blending"])
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


@pytest.mark.parametrize("method", list(PAIRWISE))
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


@pytest.mark.parametrize("method", [m for m in PAIRWISE if m != "cut"])
@pytest.mark.parametrize("specification", SPECS)
def test_anywhere_a_method_joins_by_its_own_length_or_says_that_there_is_no_room(
    bodies, method, specification
):
    a, b = bodies.wandering(24, 4), bodies.wandering(31, 5)
    rng, joined = np.random.default_rng(0), 0
    for i, j in rng.integers(0, [24, 31], (60, 2)):
        with suppress(InputError):
            done = transition(a, b, int(i), int(j), method=method, specification=specification)
            check_ends(done, a, b)
            joined += 1
            continue
        if method != "fixed":
            with pytest.raises(InputError, match="the shortest leaves"):
                blend_length(a, b, int(i), int(j), method, specification)
    assert joined > 20


@pytest.mark.parametrize("method", [m for m in PAIRWISE if m != "cut"])
@pytest.mark.parametrize("specification", SPECS)
def test_anywhere_a_given_length_is_kept_or_refused_with_the_longest_that_there_is(
    bodies, method, specification
):
    a, b = bodies.wandering(24, 4), bodies.wandering(31, 5)
    rng, refused = np.random.default_rng(1), 0

    def join(i: int, j: int, frames: int) -> Transition:
        return transition(a, b, i, j, method=method, specification=specification, frames=frames)

    for i, j, frames in rng.integers([0, 0, 1], [24, 31, 20], (80, 3)).tolist():
        try:
            done = join(i, j, frames)
        except InputError as error:
            refused += 1
            told = re.search(r"from 1 to (\d+) frames, found", str(error))
            longest = int(told[1]) if told else 0
            assert longest < frames
            if longest:
                assert join(i, j, longest).frames == longest
            continue
        assert done.frames == frames
        check_ends(done, a, b)
    assert 5 < refused < 60


def check_ends(done: Transition, a: Motion, b: Motion) -> None:
    """The result is A before the frames mixed and B behind them, up to B's end."""
    first, last = done.mixed
    assert 0 <= first <= last < len(done.motion)
    assert np.array_equal(done.motion.rotations[:first], a.rotations[:first])
    tail = len(done.motion) - last - 1
    assert np.allclose(done.motion.rotations[last + 1 :, 1:], b.rotations[len(b) - tail :, 1:])
    if done.method != "timewarp":
        lag = SPECIFICATIONS[done.specification](done.i, done.j, done.frames).lag
        assert len(done.motion) == len(b) - lag


def test_a_given_length_stretches_the_windows_of_a_timewarp(bodies):
    a, b = bodies.wandering(130, 4), bodies.wandering(130, 5)
    own = transition(a, b, 62, 66, method="timewarp")
    again = transition(a, b, 62, 66, method="timewarp", frames=own.frames)
    assert dict(own.report) == dict(again.report)
    longer = transition(a, b, 62, 66, method="timewarp", frames=20)
    windows = longer.report["from_frames"], longer.report["to_frames"]
    assert max(windows) == 20
    assert min(windows) >= 10
    pairs, costs = timewarp_costs(a, b, 62, 66, "start-end")
    assert longer.report["cost"] == np.nanmin(costs[pairs.max(axis=1) == 20])
    assert transition_measures(longer)["geodesic_cost"] == longer.report["cost"]


def test_a_given_length_stretches_the_schedule_of_the_joints(bodies):
    a, b = bodies.wandering(130, 4), bodies.wandering(130, 5)
    own = blend_length(a, b, 62, 66, "per-joint").report["schedule"]
    half = max(own.values()) // 2
    done = transition(a, b, 62, 66, method="per-joint", frames=half)
    for role, length in own.items():
        assert abs(done.report["schedule"][role] - length / 2) <= 0.5
    assert len(set(own.values())) > 1
    plain = transition(a, b, 62, 66, method="fixed", frames=half)
    assert quat.geodesic(plain.motion.rotations, done.motion.rotations).max() > 1e-3


def test_inertialization_starts_on_a_with_its_velocity_and_settles_on_b(bodies):
    a, b = bodies.wandering(60, 6), bodies.wandering(80, 7)
    for method in ("inertialization", "inertialization-spring"):
        done = transition(a, b, 25, 40, method=method, frames=12)
        assert quat.geodesic(done.motion.rotations[25], a.rotations[25]).max() < 1e-7
        assert np.allclose(done.motion.rotations[37:, 1:], b.rotations[41:, 1:])


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
