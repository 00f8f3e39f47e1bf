"""Small files that outsiders' programs and people produce: each does what its row expects."""

import csv
from pathlib import Path

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion import Clip, forward, load_clip
from tests.conftest import NO_CASES

CASES = Path(__file__).resolve().parents[4] / "shared" / "cases" / "motion"


def rows() -> list[dict[str, str]]:
    if not CASES.is_dir():
        return []
    with (CASES / "EXPECTED.csv").open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


ROWS = {row["file"]: row["expected"] for row in rows()}
EXACT = [name for name, expected in ROWS.items() if expected.startswith("exact")]
SPECIAL = {"53_joint_zero_channels.bvh"}  # exact as far as a knee without channels can be
REFUSED = {  # what a refusal must tell
    "12_missing_space_numbers.bvh": (":152:", "'98.000000-1.367493'"),
    "21_offset_missing_knee.bvh": (":99:", "OFFSET", "'LeftLeg'"),
    "23_channels_missing_knee.bvh": (":129:", "63 numbers", "66"),
    "24_offset_twice.bvh": (":85:", "OFFSET", "'LeftLeg'"),
    "26_offset_two_numbers.bvh": (":80:", "three numbers"),
    "30_frame_time_int_ms.bvh": (":129:", "0.0005 to 1 seconds", "33.3333"),
    "31_frame_time_comma.bvh": (":129:", "0,0333333"),
    "66_positions_all_zero.bvh": ("positions", "0 in all frames"),
    "80_two_roots.bvh": ("one ROOT", "Hips2"),
    "85_trailing_garbage.bvh": (":154:", "'END'"),
    "86_utf16_nobom.bvh": ("text", "binary"),
    "89_semicolon.bvh": (":130:", "a number"),
    "acclaim/tibia_length_missing": ("x.asf:33:", "length"),
    "acclaim/nan_value": ("x_01.amc:13:", "rtoes", "nan"),
}
READ = {  # frames a second, and a piece of a warning
    "32_frames_too_low.bvh": (30, "24 are there: the first 20 used"),
    "35_ft_60_as_0.0167.bvh": (60, "0.0167 would be 59.88"),
    "37_ft_24_as_0.04.bvh": (25, "0.04"),
    "51_root_no_position.bvh": (30, "no position channels"),
}

if not ROWS:
    pytest.skip(NO_CASES, allow_module_level=True)


def case(name: str) -> Clip:
    path = CASES / name
    return load_clip(path / "x_01.amc" if path.is_dir() else path)


def places(clip: Clip) -> np.ndarray:
    motion = clip.motion
    return forward(motion.skeleton, motion.rotations, motion.root)[0]


def test_every_case_has_a_test():
    roles = {name for name, expected in ROWS.items() if expected.startswith("every role")}
    tested = {*EXACT, *REFUSED, *READ, *roles}
    assert set(ROWS) - tested == {"65_shoulder_only_6ch.bvh", "acclaim/upper_keywords"}
    assert all("refuse" in ROWS[name] for name in REFUSED)


@pytest.mark.parametrize("name", sorted(set(EXACT) - REFUSED.keys() - SPECIAL))
def test_what_is_expected_exact_has_the_places_of_base(name):
    if "or refuse" in ROWS[name] and name == "34_frames_float.bvh":
        with pytest.raises(InputError, match=r"34_frames_float\.bvh:128: .* found 'Frames: 24\.0'"):
            case(name)
        return
    found = case(name)
    assert np.allclose(places(found), places(case("00_base.bvh")), atol=1e-7)
    assert "warned" not in ROWS[name] or found.warnings
    assert "roles found" not in ROWS[name] or not found.roles_missing


@pytest.mark.parametrize("name", sorted(name for name in ROWS if name.startswith("roles_")))
def test_every_role_is_found_by_name(name):
    found = case(name)
    assert found.roles_missing == ()
    assert found.warnings == ()
    base = case("00_base.bvh").motion.skeleton
    assert dict(found.motion.skeleton.roles) == dict(base.roles)
    assert np.allclose(places(found), places(case("00_base.bvh")), atol=1e-7)


@pytest.mark.parametrize("name", sorted(REFUSED))
def test_what_cannot_be_right_is_refused_in_words(name):
    with pytest.raises(InputError) as caught:
        case(name)
    message = str(caught.value)
    assert all(piece in message for piece in REFUSED[name]), message
    assert len(message.splitlines()) <= 2


@pytest.mark.parametrize("name", sorted(READ))
def test_what_is_doubtful_is_read_with_a_warning(name):
    fps, told = READ[name]
    found = case(name)
    assert found.fps == fps
    assert any(told in note for note in found.warnings)


def test_a_knee_without_channels_stays_at_rest():
    found, base = case("53_joint_zero_channels.bvh"), case("00_base.bvh")
    names = base.motion.skeleton.names
    feet = [k for k, name in enumerate(names) if name.endswith(("Foot", "ToeBase"))]
    above = np.delete(np.arange(len(names)), feet)
    assert np.allclose(places(found)[:, above], places(base)[:, above], atol=1e-7)
    knees = base.motion.skeleton.role("left_knee", "right_knee")
    assert np.all(found.motion.rotations[:, knees, 1:] == 0)
    others = np.delete(np.arange(len(names)), knees)
    assert np.allclose(found.motion.rotations[:, others], base.motion.rotations[:, others])


def test_positions_of_one_shoulder_are_averaged():
    found, base = case("65_shoulder_only_6ch.bvh"), case("00_base.bvh")
    assert np.allclose(places(found), places(base), atol=1e-3)
    assert not found.roles_missing


def test_keywords_of_acclaim_in_upper_case_are_read_alike():
    found, base = case("acclaim/upper_keywords"), case("acclaim/base")
    assert np.allclose(places(found), places(base), atol=1e-12)
    assert found.motion.skeleton.names == base.motion.skeleton.names
