"""The foot lock magnifies no rounding: joins of motions that differ by next to nothing.

Processors differ in the last digits of a sum, 1e-15 or so. What a lock makes of that is what its
poses are good for across machines, and it must stay far below what anybody could see.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion import Library, Motion, write_walker
from stimuli.motion import quaternions as quat
from stimuli.transition import transition, with_room
from stimuli.transition.hold import FAINT, slid
from stimuli.transition.ik import bend_axis, reach_out
from stimuli.transition.methods import PAIRWISE
from stimuli.transition.plants import leg_pose
from tests.conftest import SHARED

SEED = 15
JOINS = 120
MOST = 1e5  # times a difference, in any join
USUALLY = 1000.0  # times a difference, in nine of ten


def nearly(motion: Motion, apart: float, rng: np.random.Generator) -> Motion:
    """The motion with every number changed by about `apart`."""
    noise = (rng.standard_normal(part.shape) for part in (motion.rotations, motion.root))
    rotations, root = (
        part + apart * change
        for part, change in zip((motion.rotations, motion.root), noise, strict=True)
    )
    return Motion(motion.skeleton, quat.normalise(rotations), root, motion.fps)


def apart(one: Motion, other: Motion) -> float:
    """The largest difference of two motions, half-angle radians or metres."""
    turned = quat.geodesic(one.rotations, other.rotations).max()
    return float(max(turned, np.abs(one.root - other.root).max()))


Drawn = tuple[Motion, Motion, int, int, dict[str, object]]


def drawn(clips: list[Motion], rng: np.random.Generator) -> Iterator[Drawn]:
    """Joins of two of the clips anywhere, of any length, in either specification."""
    count = 0
    while count < JOINS:
        a, b = (clips[int(n)] for n in rng.integers(len(clips), size=2))
        if not a.skeleton.same_hierarchy(b.skeleton):
            continue
        a, i = with_room(a, int(rng.integers(len(a))))
        b, j = with_room(b, int(rng.integers(len(b))))
        how = {
            "frames": int(rng.integers(3, 31)),
            "specification": ("start-end", "center-aligned")[int(rng.integers(2))],
        }
        try:
            transition(a, b, i, j, **how)  # type: ignore[arg-type]
        except InputError:  # too near an end
            continue
        count += 1
        yield a, b, i, j, how


@pytest.fixture(scope="module")
def walkers(tmp_path_factory: pytest.TempPathFactory) -> list[Motion]:
    folder = tmp_path_factory.mktemp("walkers")
    for seed in range(3):
        write_walker(folder, seed)
    return everything(folder)


def everything(*folders: Path) -> list[Motion]:
    library = Library(folders)
    return [library.load(path).motion for path in library.paths()]


@pytest.fixture(params=["generated", "captured"])
def clips(request: pytest.FixtureRequest) -> list[Motion]:
    """Generated walkers; the sample motions and whatever captured motion there is beside them."""
    if request.param == "generated":
        made: list[Motion] = request.getfixturevalue("walkers")
        return made
    folders = [request.getfixturevalue("sample_motions")]
    if SHARED.is_dir():
        folders += [SHARED / "cmu_bvh", SHARED / "accad_male1_bvh"]
    return everything(*folders)


@pytest.mark.parametrize("difference", [1e-15, 1e-12, 1e-9])
def test_joins_of_nearly_the_same_motions_are_nearly_the_same(
    clips: list[Motion], difference: float
) -> None:
    rng = np.random.default_rng(SEED)
    gains = []
    for a, b, i, j, how in drawn(clips, rng):
        near = (nearly(a, difference, rng), nearly(b, difference, rng))
        one = transition(a, b, i, j, foot_lock=True, **how)  # type: ignore[arg-type]
        other = transition(*near, i, j, foot_lock=True, **how)  # type: ignore[arg-type]
        gains.append(apart(one.motion, other.motion) / difference)
    assert np.median(gains) > 1, "the motions were not changed"
    assert max(gains) < MOST
    assert np.quantile(gains, 0.9) < USUALLY


@pytest.mark.parametrize("method", [name for name in PAIRWISE if name != "cut"])
def test_a_motion_that_goes_on_into_itself_is_left_as_it_is(
    clips: list[Motion], method: str
) -> None:
    """Both have a foot in one place: nothing to hold, nothing to move.

    Dead blending alone slides by itself there, as it leaves both for their last velocities.
    """
    done = 0
    chosen = clips[:: 1 if len(clips) < 12 else 8]
    for motion in chosen:
        a, i = with_room(motion, len(motion) // 2)
        for specification, frames in (("start-end", 10), ("center-aligned", 20)):
            if not 31 <= i < len(a) - 31:
                continue
            j = i + (frames - 1) * (specification == "start-end")
            try:
                free, held = (
                    transition(a, a, i, j, method=method, frames=frames,
                               specification=specification, foot_lock=lock)
                    for lock in (False, True)
                )  # fmt: skip
            except InputError:  # where a method asks for more frames than there are
                continue
            done += 1
            assert np.array_equal(free.motion.root, held.motion.root)
            assert np.array_equal(free.motion.rotations, held.motion.rotations)
            if method in ("fixed", "geodesic", "velocity", "velocity-speed"):
                np.testing.assert_allclose(held.motion.root, a.root, atol=1e-9)
    assert done >= len(chosen)


@pytest.fixture(params=["sample", "captured"])
def standing(request: pytest.FixtureRequest) -> Motion:
    """Who stands and sways: captured; or a sample's pose, swayed over the floor by millimetres."""
    if request.param == "captured":
        folder = request.getfixturevalue("motions") / "accad_male1_bvh"
        return Library([folder]).load("Male1_A1_Stand").motion
    pose = Library([request.getfixturevalue("sample_motions")]).load("humanoid3d_jump").motion
    slow = np.arange(120)[:, None] * 2 * np.pi / np.array([90.0, 1.0, 70.0])
    root = pose.root[0] + np.sin(slow) * np.array([0.003, 0.0, 0.002])
    return Motion(pose.skeleton, np.tile(pose.rotations[0], (120, 1, 1)), root, pose.fps)


def test_a_standing_figure_s_feet_stay_where_they_are(standing: Motion) -> None:
    """Half a second on, too, where the blend shifts them by less a frame than is seen."""
    for i, j, frames in ((30, 56, 10), (40, 57, 20), (40, 86, 30)):
        free, held = (
            leg_pose(transition(standing, standing, i, j, frames=frames, foot_lock=lock).motion,
                     slice(None))
            for lock in (False, True)
        )  # fmt: skip
        for part in ("ankle", "toe"):
            assert np.abs(getattr(free, part) - getattr(held, part)).max() < 5e-4


def test_what_a_blend_adds_to_a_step_is_held_and_what_was_captured_is_not() -> None:
    captured = np.tile([0.003, 0.0, 0.001], (4, 1))
    added = np.array([0.0, 0.1, 1.0, 20.0])[:, None] * FAINT * np.array([0.0, 0.0, 1.0])
    held = np.linalg.norm(slid(captured + added, captured), axis=1)
    whole = np.linalg.norm(captured + added, axis=1)
    assert held[0] == 0.0
    assert held[1] < 0.001 * whole[1]
    assert 0.4 < held[2] / whole[2] < 0.6
    assert held[3] > 0.999 * whole[3]


def test_straight_knees_turn_by_next_to_nothing_for_next_to_nothing() -> None:
    """Straight to the last digit, a little bent and a little overstretched are as one."""
    angle = np.repeat([0.0, 1e-9, -1e-9, 1e-16, -1e-16], 3)
    size = len(angle)
    shorter = np.tile([0.0, 1e-7, 0.01], 5)
    hip, knee = np.zeros((size, 3)), np.tile([0.0, -0.45, 0.0], (size, 1))
    shank = 0.4 * np.stack([0 * angle, -np.cos(angle), -np.sin(angle)], axis=-1)
    across = np.tile([1.0, 0.0, 0.0], (size, 1))
    upright = np.tile(quat.IDENTITY, (size, 1))
    hinge, side = bend_axis(knee, shank, upright, across)
    assert np.allclose(hinge, across, atol=1e-6)
    target = knee + shank + shorter[:, None] * np.array([0.0, 1.0, 0.0])
    turned = np.stack(reach_out(hip, knee, knee + shank, target, hinge, side), axis=1)
    turned = turned.reshape(5, 3, 2, 4)
    assert quat.geodesic(turned, turned[:1]).max() < 1e-5
    assert quat.geodesic(turned[:, 0], quat.IDENTITY).max() == 0.0
    assert quat.geodesic(turned[:, 2], quat.IDENTITY).min() > 0.05
