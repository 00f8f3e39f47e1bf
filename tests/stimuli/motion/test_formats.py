"""Acclaim and DeepMimic, and what is refused with a way out."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stimuli.errors import InputError
from stimuli.motion import forward, load_clip
from stimuli.motion import quaternions as quat
from stimuli.motion.formats import acclaim_poses
from stimuli.motion.formats.acclaim_skeleton import read_asf
from stimuli.motion.formats.deepmimic import read_deepmimic
from tests.conftest import SHARED
from tests.corpora import CORPORA

ASF = """:version 1.10
:units
  mass 1.0
  length 1.0
  angle deg
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 0 0
   orientation 0 0 0
:bonedata
  begin
     id 1
     name thigh
     direction 0 -1 0
     length 2.0
     axis 0 0 30 XYZ
    dof rx ry rz
  end
  begin
     id 2
     name shin
     direction 0 -1 0
     length 3.0
     axis 0 0 0 XYZ
    dof rx
  end
:hierarchy
  begin
    root thigh
    thigh shin
  end
"""
AMC = """:FULLY-SPECIFIED
:DEGREES
1
root 1 5 2 0 90 0
thigh 10 20 30
shin 45
2
root 1 5 2 0 90 0
thigh 10 20 30
shin 45
"""


@pytest.fixture
def acclaim(tmp_path):
    """Writes an ASF and an AMC; returns the AMC's path."""

    def write(asf: str = ASF, amc: str = AMC, name: str = "07_01"):
        (tmp_path / "07.asf").write_text(asf)
        path = tmp_path / f"{name}.amc"
        path.write_text(amc)
        return path

    return write


def test_a_bone_turns_in_the_frame_of_its_axis(acclaim):
    motion = load_clip(acclaim(), scale=1.0, up="Y").motion
    positions, _ = forward(motion.skeleton, motion.rotations, motion.root)
    axis = quat.about("Z", np.radians(30))
    inner = quat.multiply(
        quat.about("Z", np.radians(30)),
        quat.multiply(quat.about("Y", np.radians(20)), quat.about("X", np.radians(10))),
    )
    turn = quat.multiply(quat.multiply(axis, inner), quat.inverse(axis))
    world = quat.multiply(quat.about("Y", np.pi / 2), turn)
    shin = motion.skeleton.names.index("shin")
    expected = np.array([1, 5, 2]) + quat.rotate(world, np.array([0.0, -2.0, 0.0]))
    assert np.allclose(positions[0, shin], expected)


def test_radians_and_degrees_are_the_same_motion(acclaim):
    degrees = load_clip(acclaim(), scale=1.0, up="Y").motion
    lines = []
    for line in AMC.replace(":DEGREES", ":RADIANS").splitlines():
        name, *values = line.split()
        if name == "root":
            values = values[:3] + [repr(float(np.radians(float(v)))) for v in values[3:]]
        elif name in ("thigh", "shin"):
            values = [repr(float(np.radians(float(v)))) for v in values]
        lines.append(" ".join([name, *values]))
    asf = ASF.replace("angle deg", "angle rad").replace("0 0 30", f"0 0 {float(np.radians(30))!r}")
    radians = load_clip(acclaim(asf, "\n".join(lines)), scale=1.0, up="Y").motion
    assert np.allclose(radians.rotations, degrees.rotations, atol=1e-12)


def test_any_rate_can_be_given_and_120_is_taken_otherwise(acclaim):
    assert load_clip(acclaim(), scale=1.0).fps == 120
    assert load_clip(acclaim(), scale=1.0, fps=59.94).fps == pytest.approx(60, rel=2e-3)
    (acclaim().parent / "overrides.toml").write_text("fps = 60\n")
    assert load_clip(acclaim(), scale=1.0).fps == 60


@pytest.mark.parametrize(
    ("asf", "amc", "told"),
    [
        (("thigh shin", "thigh foot"), ("", ""), "foot"),
        (("direction 0 -1 0", "direction 0 -1"), ("", ""), "3 numbers"),
        ((":hierarchy", ":tree"), ("", ""), ":hierarchy"),
        (("axis 0 0 30 XYZ", "axis 0 0 30 XXZ"), ("", ""), "axis order"),
        (("    thigh shin\n", ""), ("", ""), "loose"),
        (("", ""), ("shin 45\n2", "2"), "shin"),
        (("", ""), ("shin 45\n2", "shin 45\n3"), "frame 2"),
        (("", ""), ("thigh 10 20 30", "thigh 10 20"), "3 numbers for thigh"),
        (("", ""), ("shin 45", "shin nan"), "numbers"),
        (("", ""), ("shin 45", "shin 4_5"), "numbers"),
        (("", ""), ("shin 45", "shin ٤٥"), "numbers"),
        (("", ""), ("shin 45", "shin 1e9"), "below 1e9"),
        (("", ""), ("thigh 10 20 30\nshin 45", "thigh 10 20\nshin 45 30"), "3 numbers for thigh"),
        (("", ""), ("45\n2\n", "45\n²\n"), "frame 2, found frame '²'"),
        (("", ""), ("45\n2\n", f"45\n{'9' * 5000}\n"), "frame 2, found frame '999"),
        (("", ""), ("DEGREES\n1\n", f"DEGREES\n{'9' * 5000}\n"), "a frame number"),
        (("length 2.0", "length 2_0"), ("", ""), "numbers"),
        (("axis 0 0 30", "axis 0 0 ٣"), ("", ""), "numbers"),
        (("", ""), ("1\nroot", "root"), "a frame number"),
    ],
)
def test_faults_of_acclaim_are_named(acclaim, asf, amc, told):
    with pytest.raises(InputError, match=told):
        load_clip(acclaim(ASF.replace(*asf, 1), AMC.replace(*amc, 1)))


def poses_alike(amc: str, name: str = "07_01") -> bool:
    """Whether an AMC is read as a table, with what it gives line by line."""
    skeleton = read_asf(Path("07.asf"), ASF)
    widths = {bone.name: len(bone.freedoms) for bone in skeleton.bones}
    table = acclaim_poses._as_table(Path(name), amc, widths, skeleton.degrees)
    if table is None:
        return False
    lines = acclaim_poses._line_by_line(Path(name), amc, widths, skeleton.degrees)
    assert table.degrees == lines.degrees
    assert list(table.values) == list(lines.values)
    assert all(np.array_equal(table.values[bone], lines.values[bone]) for bone in lines.values)
    return True


@pytest.mark.parametrize(
    ("change", "regular"),
    [
        (("", ""), True),
        (("\n", "\r\n"), True),
        ((":DEGREES", ":RADIANS\n# of Segue\n"), True),
        (("45", "4.5e-014"), True),
        (("45\n2\n", "-.45\n2 \n"), True),
        (("thigh ", "thigh\t"), True),
        (("45\n2\n", "45\n\n2\n"), False),
        (("45\n2\nroot 1 5 2 0 90 0\nthigh 10 20 30\nshin 45",
          "45\n2\nshin 45\nroot 1 5 2 0 90 0\nthigh 10 20 30"), False),
        (("45\n2\n", "45\n# between\n2\n"), False),
        (("45\n2\n", "45\n:RADIANS\n2\n"), False),
        (("1\nroot", "01\nroot"), False),
        ((" 30\n", " 30\n "), False),
    ],
)  # fmt: skip
def test_frames_laid_out_alike_are_read_as_one_table(acclaim, change, regular):
    amc = AMC.replace(*change)
    assert poses_alike(amc) == regular
    (acclaim().parent / "07_01.amc").write_text(amc)
    assert len(load_clip(acclaim().parent / "07_01.amc").motion) == 1


@settings(max_examples=300)
@given(st.data())
def test_a_table_of_poses_is_what_its_lines_say(data):
    amc = AMC
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(amc)))
        end = data.draw(st.integers(start, min(start + 3, len(amc))))
        amc = amc[:start] + data.draw(st.text("012 .-e\n\t\r\x0b\x1c#:n", max_size=4)) + amc[end:]
    poses_alike(amc)


def test_captured_acclaim_is_read_as_tables(motions):
    for path in sorted((motions / "cmu_asfamc").glob("*.amc")):
        skeleton = read_asf(path, (path.parent / f"{path.stem[:2]}.asf").read_text())
        widths = {bone.name: len(bone.freedoms) for bone in skeleton.bones}
        assert acclaim_poses._as_table(path, path.read_text(), widths, True) is not None, path


def test_a_skeleton_that_cannot_be_read_is_a_refusal(tmp_path):
    (tmp_path / "07.asf").mkdir()
    (tmp_path / "07_01.amc").write_text(AMC)
    with pytest.raises(InputError, match=r"07\.asf: expected a file to read"):
        load_clip(tmp_path / "07_01.amc")


def test_an_amc_without_its_skeleton_says_which_is_missing(tmp_path):
    (tmp_path / "07_01.amc").write_text(AMC)
    with pytest.raises(InputError, match=r"07\.asf"):
        load_clip(tmp_path / "07_01.amc")


def test_acclaim_and_its_bvh_conversion_are_one_motion(motions):
    for name in ("05_13", "16_41"):
        a = load_clip(motions / "cmu_asfamc" / f"{name}.amc").motion
        b = load_clip(motions / "cmu_from_amc_bvh" / f"{name}.bvh").motion
        order = [a.skeleton.names.index(joint) for joint in b.skeleton.names]
        p, _ = forward(a.skeleton, a.rotations, a.root)
        q, _ = forward(b.skeleton, b.rotations, b.root)
        assert np.abs(p[:, order] - q).max() < 1e-6


@settings(max_examples=100)
@given(st.data())
def test_damaged_acclaim_is_a_motion_or_a_refusal(tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("acclaim")
    for name, text in (("07.asf", ASF), ("07_01.amc", AMC)):
        start = data.draw(st.integers(0, len(text)))
        end = data.draw(st.integers(start, min(start + 9, len(text))))
        (folder / name).write_text(
            text[:start] + data.draw(st.text("0 19-e:\nxr", max_size=4)) + text[end:]
        )
    try:
        clip = load_clip(folder / "07_01.amc")
    except InputError:
        return
    assert np.all(np.isfinite(clip.motion.rotations))
    assert np.all(np.isfinite(clip.motion.root))


def test_c3d_is_refused_with_what_to_convert_it_with(tmp_path):
    """A header: where the parameters are, 0x50, 41 markers."""
    (tmp_path / "05_13.c3d").write_bytes(bytes([2, 0x50, 41, 0]) + bytes(508))
    paths = [tmp_path / "05_13.c3d", *SHARED.glob("cmu_c3d/05_13.c3d")]
    for path in paths:
        with pytest.raises(InputError, match="markers and no skeleton"):
            load_clip(path)


def frame(duration: float = 1 / 30, **changes: float) -> list[float]:
    """A frame of the humanoid in rest."""
    unit = [1.0, 0.0, 0.0, 0.0]
    values = [duration, 0, 0.9, 0, *unit, *unit, *unit]
    for _ in range(2):
        values += [*unit, -0.5, *unit, *unit, 0.25]
    for place, value in changes.items():
        values[int(place[1:])] = value
    return values


def read(document: object):
    return read_deepmimic(Path("clip.json"), json.dumps(document).encode())


def test_hinges_turn_about_z_and_the_character_faces_x():
    source = read({"Loop": "none", "Frames": [frame(), frame()]})
    assert source.fps == 30
    knee = source.names.index("right_knee")
    assert np.allclose(source.rotations[0, knee], quat.about("Z", -0.5))
    assert source.names[:4] == ("root", "chest", "neck", "right_shoulder")
    assert source.names[source.parents[source.names.index("right_wrist")]] == "right_elbow"
    assert not source.loop


def test_durations_that_vary_are_resampled_evenly():
    frames = [frame(0.1, _1=0.0), frame(0.2, _1=1.0), frame(0.1, _1=3.0), frame(0.1, _1=4.0)]
    source = read({"Frames": frames})
    assert source.fps == 10
    assert np.allclose(source.root[:, 0], [0, 1, 2, 3, 4])


@pytest.mark.parametrize(
    ("document", "told"),
    [
        ([], "Frames"),
        ({"Frames": []}, "Frames"),
        ({"Frames": [[0.1] * 20]}, "20"),
        ({"Frames": [frame(), frame()[:-1]]}, "43"),
        ({"Frames": [["a"] * 44]}, "numbers"),
        ({"Frames": [["1"] * 44]}, "found str"),
        ({"Frames": [[True] * 44]}, "found bool"),
        ({"Frames": [[[1]] * 44]}, "found list"),
        ({"Frames": [frame(_2=10**400), frame()]}, "below 1e9"),
        ({"Frames": [frame(900.0), frame()]}, "0.0005 to 1 seconds, found 900"),
        ({"Frames": [frame(step) for step in (*[5e-4] * 6, 900.0, 5e-4)]}, "found 900"),
        ({"Frames": [frame(step) for step in [5e-4] * 2001 + [1.0] * 2000]}, "at most"),
        ({"Frames": [frame(_4=0.0), frame()]}, "quaternions"),
        ({"Frames": [frame(-1.0), frame()]}, "frame time"),
        ({"Frames": [frame(_2=1e300), frame()]}, "huge"),
    ],
)
def test_faults_of_deepmimic_are_named(document, told):
    with pytest.raises(InputError, match=told):
        read(document)


@pytest.mark.parametrize("corpus", CORPORA)
def test_every_captured_clip_loads_with_the_roles_that_are_needed(corpus, sample_motions):
    from stimuli.motion.library import clips_under

    needed = {"left_hip", "right_knee", "left_shoulder", "right_elbow", "pelvis", "spine", "head"}
    folder, least = {"sample": (sample_motions, 20), "captured": (SHARED, 145)}[corpus]
    paths = [p for p in clips_under(folder) if p.parent.name not in ("messy", "cmu_c3d")]
    for path in paths:
        clip = load_clip(path)
        assert needed <= set(clip.motion.skeleton.roles), path
        assert np.all(np.isfinite(clip.motion.root)), path
    assert len(paths) >= least
