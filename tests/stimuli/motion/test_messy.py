"""Every odd or malformed file of the messy folder does what its manifest line expects."""

import csv
from pathlib import Path

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion import forward, load_clip
from tests.conftest import NO_CASES

MESSY = Path(__file__).resolve().parents[4] / "shared" / "motions" / "messy"
SAID = {  # what a refusal must tell, where the manifest asks for it or a person needs it
    "amc_frame_gap.amc": ("304", "frame 11", "12"),
    "amc_unknown_bone.amc": ("31", "lshin"),
    "brace_missing.bvh": ("}",),
    "channels_count_wrong.bvh": (":9", "CHANNELS 4"),
    "empty.bvh": ("empty",),
    "frame_time_missing.bvh": ("187", "Frame Time"),
    "frame_time_zero.bvh": ("187", "found 0"),
    "garbage.bvh": ("binary",),
    "html_error_page.bvh": ("web page",),
    "lfs_pointer.bvh": ("git lfs pull",),
    "no_motion.bvh": ("MOTION",),
    "row_too_long.bvh": ("197", "frame 10 has 97"),
    "truncated_last_line.bvh": ("217", "2855", "frame 30 has 71"),
    "two_roots.bvh": ("185", "one ROOT", "Prop"),
}


def rows() -> list[dict[str, str]]:
    if not MESSY.is_dir():
        return []
    with (MESSY / "MANIFEST.csv").open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def files(kind: str) -> list[str]:
    return [row["path"] for row in rows() if row["kind"].startswith(kind)]


def positions(name: str) -> np.ndarray:
    motion = load_clip(MESSY / name).motion
    return forward(motion.skeleton, motion.rotations, motion.root)[0]


if not rows():
    pytest.skip(NO_CASES, allow_module_level=True)


@pytest.mark.parametrize("name", sorted(SAID.keys() & {row["path"] for row in rows()}))
def test_malformed_files_are_refused_with_what_a_person_needs(name: str):
    with pytest.raises(InputError) as caught:
        load_clip(MESSY / name)
    message = str(caught.value)
    assert name in message
    assert len(message.splitlines()) <= 2
    assert all(piece in message for piece in SAID[name]), message


def test_every_malformed_file_is_known_here():
    lenient = {"count_too_low.bvh", "utf16.bvh"}
    assert set(files("malformed")) - lenient <= set(SAID)


@pytest.mark.parametrize(
    "row", [r for r in rows() if r["expected"].startswith(("same as base", "same position"))] +
    [r for r in rows() if r["path"] in ("no_end_sites.bvh", "utf16.bvh")],
    ids=lambda row: row["path"],
)  # fmt: skip
def test_valid_but_odd_files_give_the_positions_of_base(row: dict[str, str]):
    assert np.allclose(positions(row["path"]), positions("base.bvh"), atol=2e-5)


def test_carriage_returns_in_amc():
    assert np.array_equal(positions("amc_crlf.amc"), positions("ok.amc"))


def test_base_has_what_the_manifest_says():
    base = load_clip(MESSY / "base.bvh")
    assert (base.frames, base.joints, base.fps) == (30, 31, 120.0)


def test_acclaim_reference_has_what_the_manifest_says():
    clip = load_clip(MESSY / "ok.amc", fps=60)
    assert (clip.frames, clip.joints, clip.fps) == (20, 31, 60.0)
    assert load_clip(MESSY / "ok.amc").fps == 120.0
    assert "120" in load_clip(MESSY / "ok.amc").warnings[0]


def test_a_header_that_counts_too_few_frames_warns():
    clip = load_clip(MESSY / "count_too_low.bvh")
    assert clip.frames == 25
    assert "30 are there" in clip.warnings[0]


def test_a_rounded_frame_time_is_sixty_a_second():
    assert load_clip(MESSY / "ft_60hz_rounded.bvh").fps == 60.0


@pytest.mark.parametrize(
    ("name", "frames", "joints", "fps", "up"),
    [
        ("only_root_end_site.bvh", 2, 1, 30, "Y"),
        ("real_accad_run.bvh", 36, 22, 30, "Y"),
        ("real_freebvh_55j.bvh", 69, 55, 30, "Y"),
        ("real_mocapbank_crlf.bvh", 455, 19, 30, "Y"),
        ("real_pybvh_test3_zup_60j.bvh", 100, 60, 120, "Z"),
        ("real_skeleton_one_frame.bvh", 1, 24, 120, "Z"),
        ("real_walk01_24fps.bvh", 101, 19, 24, "Y"),
    ],
)
def test_real_files(name: str, frames: int, joints: int, fps: float, up: str):
    clip = load_clip(MESSY / name)
    assert (clip.frames, clip.joints, clip.fps, clip.up) == (frames, joints, fps, up)


def test_angles_that_wrap_are_interpolated_as_rotations():
    wrapped, base = (load_clip(MESSY / f"{name}.bvh", fps=50).motion
                     for name in ("degrees_wrapped", "base"))  # fmt: skip
    dots = np.abs(np.einsum("fji,fji->fj", wrapped.rotations, base.rotations))
    assert np.all(dots > 1 - 1e-9)
