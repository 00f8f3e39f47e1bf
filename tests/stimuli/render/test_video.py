"""Masters keep every pixel, and are whole or absent."""

import os
from collections.abc import Iterator
from pathlib import Path

import av
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stimuli.errors import InputError
from stimuli.render import decode_video, strip, write_png, write_video
from stimuli.render.strip import FOOT, chosen_frames


def noise(frames: int = 5, height: int = 48, width: int = 64, seed: int = 0) -> np.ndarray:
    generator = np.random.default_rng(seed)
    return generator.integers(0, 256, (frames, height, width, 3), dtype=np.uint8)


@settings(max_examples=12)
@given(st.integers(1, 4), st.integers(17, 70), st.integers(17, 70), st.integers(0, 99))
def test_a_master_gives_every_pixel_back(
    tmp_path_factory: pytest.TempPathFactory, frames: int, height: int, width: int, seed: int
) -> None:
    path = tmp_path_factory.mktemp("clip") / "a.mkv"
    pictures = noise(frames, height, width, seed)
    assert write_video(path, pictures, 30) == frames
    np.testing.assert_array_equal(decode_video(path), pictures)


def test_the_same_frames_give_the_same_file(tmp_path: Path) -> None:
    for name in ("a.mkv", "b.mkv"):
        write_video(tmp_path / name, noise(), 30)
    assert (tmp_path / "a.mkv").read_bytes() == (tmp_path / "b.mkv").read_bytes()


def test_a_clip_carries_its_codec_and_rate(tmp_path: Path) -> None:
    write_video(tmp_path / "a.mkv", noise(), 30)
    with av.open(str(tmp_path / "a.mkv")) as container:
        stream = container.streams.video[0]
        assert stream.codec_context.name == "ffv1"
        assert stream.average_rate == 30


def test_mp4_is_for_looking_at(tmp_path: Path) -> None:
    grey = np.full((6, 48, 64, 3), 128, np.uint8)
    write_video(tmp_path / "a.mp4", grey, 30)
    shown = decode_video(tmp_path / "a.mp4")
    assert shown.shape == grey.shape
    np.testing.assert_allclose(shown.astype(int), 128, atol=3)


def test_an_odd_size_is_possible_in_mp4(tmp_path: Path) -> None:
    write_video(tmp_path / "a.mp4", noise(3, 51, 65), 30)
    assert decode_video(tmp_path / "a.mp4").shape == (3, 51, 65, 3)


def test_a_rendering_that_fails_leaves_nothing_and_keeps_what_was_there(tmp_path: Path) -> None:
    path = tmp_path / "a.mkv"
    write_video(path, noise(), 30)
    before = path.read_bytes()

    def failing() -> Iterator[np.ndarray]:
        yield noise()[0]
        raise RuntimeError("the light went out")

    with pytest.raises(RuntimeError, match="light"):
        write_video(path, failing(), 30)
    assert [p.name for p in tmp_path.iterdir()] == ["a.mkv"]
    assert path.read_bytes() == before


def test_another_ending_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"\.mkv or \.mp4"):
        write_video(tmp_path / "a.gif", noise(), 30)


@pytest.mark.parametrize("content", [b"", b"no video", b"\x1aE\xdf\xa3" + bytes(200)])
def test_what_is_no_video_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.mkv").write_bytes(content)
    with pytest.raises(InputError, match=r"a\.mkv"):
        decode_video(tmp_path / "a.mkv")


def test_a_missing_clip_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="absent"):
        decode_video(tmp_path / "absent.mkv")


def test_a_strip_shows_what_moves(tmp_path: Path) -> None:
    frames = np.full((40, 60, 200, 3), 128, np.uint8)
    for frame in range(40):
        frames[frame, 20:40, 80 + frame : 90 + frame] = 255
    picture = strip(frames, 5)
    assert picture.shape[0] == 60 + FOOT
    assert picture.shape[1] % 5 == 0
    assert picture.shape[1] // 5 < 200
    assert (strip(frames, 5, middle=20) == 255).any()
    write_png(tmp_path / "strip.png", picture)
    with av.open(str(tmp_path / "strip.png")) as image:
        shown = next(image.decode(video=0)).to_ndarray(format="rgb24")
    np.testing.assert_array_equal(shown, picture)


def test_a_strip_of_nothing_is_background() -> None:
    still = np.full((4, 20, 30, 3), 128, np.uint8)
    assert np.all(strip(still, 3)[:20] == 128)
    assert strip(still, 3).shape == (20 + FOOT, 90, 3)


def test_a_strip_numbers_its_frames_and_marks_the_blend() -> None:
    frames = np.full((90, 40, 60, 3), 128, np.uint8)
    chosen = chosen_frames(90, 6, 45)
    foot = strip(frames, 6, middle=45, mixed=(chosen[2], chosen[3] + 1))[40:]
    marked = [bool(np.any(cell[0] != 128)) for cell in np.split(foot, 6, axis=1)]
    assert marked == [False, False, True, True, False, False]
    plain = strip(frames, 6, middle=45)[40:]
    numbers = list(np.split(plain, 6, axis=1))
    assert all(np.any(cell < 100) for cell in numbers)
    assert len({cell.tobytes() for cell in numbers}) == 6


@pytest.mark.parametrize(("mask", "mode"), [(0o077, 0o600), (0o027, 0o640), (0o022, 0o644)])
def test_a_clip_is_as_private_as_its_user_s_files_are(tmp_path: Path, mask: int, mode: int) -> None:
    before = os.umask(mask)
    try:
        write_video(tmp_path / "a.mkv", [np.zeros((48, 64, 3), dtype=np.uint8)], 30)
    finally:
        os.umask(before)
    assert (tmp_path / "a.mkv").stat().st_mode & 0o777 == mode
