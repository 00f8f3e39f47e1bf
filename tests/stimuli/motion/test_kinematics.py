"""Forward kinematics against homogeneous matrices; headings of known poses."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from stimuli.motion import end_positions, forward, heading, load_clip
from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import _by_levels, _followed, headings, joint_positions, placed
from tests.conftest import SHARED
from tests.corpora import CORPORA


def by_matrices(motion, frame):
    """Joint and end positions of a frame, by 4 × 4 matrices down the chain."""
    skeleton, world = motion.skeleton, []
    for joint, parent in enumerate(skeleton.parents):
        local = np.eye(4)
        quaternion = motion.rotations[frame, joint]
        local[:3, :3] = Rotation.from_quat(quaternion, scalar_first=True).as_matrix()
        local[:3, 3] = motion.root[frame] if parent < 0 else skeleton.offsets[joint]
        world.append(local if parent < 0 else world[parent] @ local)
    ends = [
        (world[parent] @ [*offset, 1.0])[:3]
        for parent, offset in zip(skeleton.end_parents, skeleton.end_offsets, strict=True)
    ]
    return np.array([matrix[:3, 3] for matrix in world]), np.array(ends)


def assert_forward_agrees(motion, frames):
    positions, orientations = forward(motion.skeleton, motion.rotations, motion.root)
    ends = end_positions(motion.skeleton, positions, orientations)
    for frame in frames:
        joints, tips = by_matrices(motion, frame)
        assert np.allclose(positions[frame], joints, atol=1e-12)
        assert np.allclose(ends[frame], tips, atol=1e-12)


def test_forward_kinematics_is_the_product_of_matrices(bodies):
    assert_forward_agrees(bodies.wandering(5, 0), range(5))


def test_forward_kinematics_of_captured_motions(sample_motions):
    captured = [SHARED / "cmu_bvh/05_13.bvh", SHARED / "other_bvh/rokoko_jesse_dance.bvh"]
    for path in [sample_motions / "humanoid3d_spin.json"] + captured * SHARED.is_dir():
        assert_forward_agrees(load_clip(path).motion, (0, 50, 100))


def test_forward_broadcasts_over_leading_axes(bodies):
    motion = bodies.wandering(6, 1)
    whole, _ = forward(motion.skeleton, motion.rotations, motion.root)
    split, _ = forward(
        motion.skeleton, motion.rotations.reshape(2, 3, -1, 4), motion.root.reshape(2, 3, 3)
    )
    one, _ = forward(motion.skeleton, motion.rotations[4], motion.root[4])
    # products of other shapes are summed in another order, which decides the last digit
    assert np.allclose(split.reshape(whole.shape), whole, atol=1e-12)
    assert np.allclose(one, whole[4], atol=1e-12)


def test_one_joint_by_its_chain(bodies):
    motion = bodies.wandering(4, 2)
    positions, _ = forward(motion.skeleton, motion.rotations, motion.root)
    for joint in range(len(motion.skeleton)):
        alone = joint_positions(motion.skeleton, motion.rotations, motion.root, joint)
        assert np.allclose(alone, positions[:, joint], atol=1e-12)


def test_a_character_that_faces_z_has_its_left_side_at_x(bodies):
    motion = bodies.standing()
    positions, _ = forward(motion.skeleton, motion.rotations, motion.root)
    left, right = motion.skeleton.role("left_hip", "right_hip")
    assert positions[0, left, 0] > positions[0, right, 0]
    assert np.isclose(headings(motion)[0], 0.0, atol=1e-12)


def test_heading_follows_a_turn_and_placing_moves_all_joints_rigidly(bodies):
    motion = bodies.wandering(8, 3)
    turned = placed(motion, 0.6, np.array([1.0, 0.0, -2.0]))
    change = np.angle(np.exp(1j * (headings(turned) - headings(motion))))
    assert np.allclose(change, 0.6, atol=1e-12)
    before, _ = forward(motion.skeleton, motion.rotations, motion.root)
    after, _ = forward(turned.skeleton, turned.rotations, turned.root)
    expected = quat.rotate(quat.about("Y", 0.6), before) + np.array([1.0, 0.0, -2.0])
    assert np.allclose(after, expected, atol=1e-12)


@pytest.mark.parametrize("corpus", CORPORA)
def test_heading_is_that_of_the_walk(corpus, sample_motions):
    name = {"sample": "humanoid3d_walk", "captured": "35_01"}[corpus]
    motion = CORPORA[corpus][name][:78]  # two strides of the sample's
    step = motion.root[-1] - motion.root[0]
    yaw = heading(motion.skeleton, motion.rotations[45], motion.root[45])
    facing = np.array([np.sin(yaw), np.cos(yaw)])
    assert facing @ step[[0, 2]] / np.linalg.norm(step[[0, 2]]) > 0.95


@pytest.mark.parametrize("lead", [(), (1,), (2, 3)])
def test_the_compiled_loop_goes_where_numpy_goes(bodies, lead):
    motion = bodies.wandering(6, 4)
    frames = 6 if lead == (2, 3) else 1
    rotations = motion.rotations[:frames].reshape(*lead, -1, 4)
    for root in (motion.root[:frames].reshape(*lead, 3), np.array([1.0, 2.0, 3.0])):
        rotations.flags.writeable = False
        compiled = _followed(motion.skeleton, rotations, root)
        plain = _by_levels(motion.skeleton, rotations, root)
        for ours, theirs in zip(compiled, plain, strict=True):
            assert ours.shape == theirs.shape
            assert np.allclose(ours, theirs, rtol=0, atol=1e-13)


def test_the_compiled_loop_takes_any_layout_of_numbers(bodies):
    motion = bodies.wandering(9, 4)
    every_other = motion.rotations[::2]
    single = every_other.astype(np.float32)
    compiled, _ = _followed(motion.skeleton, every_other, motion.root[::2])
    assert np.allclose(compiled, forward(motion.skeleton, motion.rotations, motion.root)[0][::2])
    rough, _ = _followed(motion.skeleton, single, motion.root[::2])
    assert np.allclose(rough, compiled, atol=1e-5)
