"""AMASS archives: the pose that is written is the pose that is read; anything else is refused."""

import io
import zipfile
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from stimuli.errors import InputError
from stimuli.motion import Library, forward, load_clip
from stimuli.motion.formats.amass import is_amass
from stimuli.motion.formats.refused import REFUSED
from stimuli.motion.roles import ROLES

FRAMES = 60
LEFT_KNEE, RIGHT_ELBOW, LEFT_INDEX = 4, 19, 22
UPRIGHT = np.array([np.pi / 2, 0.0, 0.0])


def archive(numbers: int = 156, **changes) -> dict[str, np.ndarray]:
    """A person who walks along −Y with one knee bent, in a world whose Z is up."""
    poses = np.zeros((FRAMES, numbers))
    poses[:, :3] = UPRIGHT
    poses[:, 3 * LEFT_KNEE] = np.linspace(0, 1, FRAMES)
    poses[:, 3 * RIGHT_ELBOW + 1] = 0.5
    trans = np.zeros((FRAMES, 3))
    trans[:, 1] = -0.02 * np.arange(FRAMES)
    trans[:, 2] = 0.986
    return {"poses": poses, "trans": trans, "mocap_framerate": np.array(60.0),
            "gender": np.array("neutral"), "betas": np.zeros(16)} | changes  # fmt: skip


@pytest.fixture
def written(tmp_path) -> Callable:
    """Writes arrays as an archive; returns its path."""

    def write(arrays: dict[str, np.ndarray], compressed: bool = True):
        path = tmp_path / "walk_poses.npz"
        (np.savez_compressed if compressed else np.savez)(path, **arrays)
        return path

    return write


def places(clip) -> dict[str, np.ndarray]:
    motion = clip.motion
    found = forward(motion.skeleton, motion.rotations, motion.root)[0]
    return dict(zip(motion.skeleton.names, found.transpose(1, 0, 2), strict=True))


@pytest.mark.parametrize("compressed", [True, False])
def test_a_walk_is_read_with_every_role(written, compressed):
    clip = load_clip(written(archive(), compressed))
    assert (clip.format, clip.frames, clip.fps, clip.joints) == ("amass", FRAMES, 60.0, 52)
    assert (clip.scale, clip.up, clip.roles_missing) == (1.0, "Z", ())
    assert set(clip.motion.skeleton.roles) == set(ROLES)
    assert clip.warnings == (
        "the bones are those of a standard body of 1.70 m, not of this person",
    )
    assert len(clip.motion) == FRAMES // 2


def test_the_body_stands_walks_along_z_and_bends_its_knee_backwards(written):
    found = places(load_clip(written(archive())))
    assert np.allclose(found["pelvis"][:, 1], 0.986)
    assert np.allclose(np.diff(found["pelvis"][:, 2]), 0.04)
    assert np.allclose(found["right_ankle"][:, 1], 0.0663, atol=1e-3)
    assert np.all(found["head"][:, 1] > 1.5)
    assert np.all(found["left_hip"][:, 0] > found["right_hip"][:, 0])
    behind = found["left_knee"][:, 2] - found["left_ankle"][:, 2]
    shank = 0.246 * 1.7
    assert np.allclose(behind, shank * np.sin(np.linspace(0, 1, FRAMES)[::2]), atol=1e-6)
    assert np.all(found["right_index1"][:, 0] < found["right_wrist"][:, 0])


def test_rotation_vectors_are_those_of_the_joints(written):
    rng = np.random.default_rng(0)
    poses = rng.normal(0, 0.6, (FRAMES, 156))
    poses[:, :3] = UPRIGHT
    clip = load_clip(written(archive(poses=poses, mocap_framerate=np.array(30))))
    names = ("spine2", "neck", "left_shoulder", "right_wrist")
    order = (6, 12, 16, 21)
    for name, joint in zip(names, order, strict=True):
        found = clip.motion.rotations[:, clip.motion.skeleton.names.index(name)]
        expected = Rotation.from_rotvec(poses[:, 3 * joint : 3 * joint + 3])
        apart = Rotation.from_quat(found, scalar_first=True) * expected.inv()
        assert np.max(apart.magnitude()) < 1e-7


@pytest.mark.parametrize(("numbers", "index"), [(156, 22), (165, 25), (72, None)])
def test_bodies_of_other_models_give_what_they_share(written, numbers, index):
    arrays = archive(numbers)
    if index is not None:
        arrays["poses"][:, 3 * index + 2] = 0.7
    arrays["poses"] = arrays["poses"].astype(np.float32)
    clip = load_clip(written(arrays))
    finger = clip.motion.skeleton.names.index("left_index1")
    turned = 2 * np.arcsin(clip.motion.rotations[:, finger, 3])
    assert np.allclose(turned, 0.7 if index else 0.0, atol=1e-6)
    assert any("left out" in note for note in clip.warnings) == (numbers != 156)
    other = load_clip(written(archive()))
    assert np.allclose(places(clip)["left_ankle"], places(other)["left_ankle"], atol=1e-5)


def test_one_who_lies_lies_and_a_world_with_y_up_is_said(written):
    arrays = archive()
    arrays["poses"][:, :3] = 0.0  # on the back in a world whose Z is up
    arrays["trans"][:] = [0.0, 0.0, 0.12]
    lying = load_clip(written(arrays))
    assert lying.up == "Z"
    assert np.ptp([place[:, 1].mean() for place in places(lying).values()]) < 0.6
    arrays["trans"][:] = [0.0, 0.986, 0.5]
    arrays["poses"][:, :3] = [0.0, 0.3, 0.0]
    other = load_clip(written(arrays))
    assert other.up == "Y"
    assert "amass has Z up, the body stands along Y: taken as up" in other.warnings


def test_a_rate_may_stand_under_either_name_or_be_given(written):
    arrays = archive()
    del arrays["mocap_framerate"]
    with pytest.raises(InputError, match="mocap_framerate, one number, found none"):
        load_clip(written(arrays))
    assert load_clip(written(arrays), fps=24).fps == 24
    assert load_clip(written(arrays | {"mocap_frame_rate": np.array(120)})).fps == 120
    assert load_clip(written(archive(mocap_framerate=np.array([59.96])))).fps == 60


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"poses": np.zeros((FRAMES, 150))}, r"poses \(60, 150\)"),
        ({"poses": np.zeros((0, 156))}, r"poses \(0, 156\)"),
        ({"poses": np.zeros(156)}, r"poses \(156,\)"),
        ({"poses": np.zeros((FRAMES, 52, 3))}, r"poses \(60, 52, 3\)"),
        ({"trans": np.zeros((FRAMES - 1, 3))}, r"trans \(59, 3\)"),
        ({"trans": np.full((FRAMES, 3), np.nan)}, "another in trans, frame 1"),
        ({"poses": np.full((FRAMES, 156), np.inf)}, "another in poses, frame 1"),
        ({"mocap_framerate": np.array(0.0)}, "mocap_framerate of 1 to 2000, found 0"),
        ({"mocap_framerate": np.array(np.nan)}, "found nan"),
        ({"mocap_framerate": np.array([30, 60])}, "one number"),
        ({"mocap_framerate": np.array("fast")}, "numbers in mocap_framerate"),
        ({"poses": np.full((FRAMES, 156), "x")}, "numbers in poses"),
        ({"poses": np.zeros((FRAMES, 156), dtype=complex)}, "numbers in poses"),
        ({"poses": np.full((2, 156), None)}, "numbers in poses"),
    ],
)
def test_what_is_no_motion_is_refused(written, changes, told):
    with pytest.raises(InputError, match=told) as caught:
        load_clip(written(archive(**changes)))
    assert len(str(caught.value).splitlines()) <= 2


def test_other_archives_are_refused_and_not_listed(written, tmp_path):
    path = written({"betas": np.zeros(16), "gender": np.array("male")})
    with pytest.raises(InputError, match="betas, gender: no poses and no trans"):
        load_clip(path)
    assert not is_amass(path)
    assert Library([tmp_path]).paths() == ()
    written(archive())
    assert Library([tmp_path]).paths() == (path,)
    (tmp_path / "x.npz").write_bytes(b"no archive")
    assert not is_amass(tmp_path / "x.npz")


def test_an_archive_that_claims_to_be_huge_is_not_unpacked(tmp_path):
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        header, {"descr": "<f8", "fortran_order": False, "shape": (10**9, 156)}
    )
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive_file:
        archive_file.writestr("poses.npy", header.getvalue())
        archive_file.writestr("trans.npy", header.getvalue())
    with pytest.raises(InputError, match=r"at most 300,000,000 bytes"):
        load_clip(tmp_path / "a.npz")


@settings(max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_a_damaged_archive_is_a_motion_or_a_refusal(written, data):
    small = {name: value[:3] if value.ndim > 1 else value for name, value in archive().items()}
    path = written(small, data.draw(st.booleans()))
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(content) - 1))
        content[start : start + data.draw(st.integers(0, 9))] = data.draw(st.binary(max_size=9))
    path.write_bytes(content)
    try:
        motion = load_clip(path).motion
    except InputError:
        return
    assert np.all(np.isfinite(motion.rotations))
    assert np.all(np.isfinite(motion.root))


@pytest.mark.parametrize("suffix", sorted(REFUSED))
def test_other_formats_are_refused_with_what_to_convert_with(tmp_path, suffix):
    path = tmp_path / f"walk{suffix.upper()}"
    path.write_bytes(b"anything")
    with pytest.raises(InputError) as caught:
        load_clip(path)
    where, todo = str(caught.value).splitlines()
    assert where.startswith(f"{path}: expected joint rotations of a skeleton, found ")
    assert "BVH" in todo or ".npz" in todo


def test_a_format_nobody_knows_is_refused_too(tmp_path):
    (tmp_path / "walk.xyz").write_bytes(b"x")
    with pytest.raises(InputError, match=r"known format .* found \.xyz"):
        load_clip(tmp_path / "walk.xyz")
