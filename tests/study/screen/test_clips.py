"""Clips decoded by a process of their own: every frame, in order, within a bound of memory."""

import hashlib
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from stimuli.errors import InputError, MachineError
from stimuli.render import write_video
from study.screen.clips import ClipFile, Decoder
from study.screen.ring import FIRST_BYTE, MOST_BYTES, lanes_for
from study.trials.trial import ClipKey

A, B = ClipKey("a"), ClipKey("b")


def numbered(count: int, first: int) -> np.ndarray:
    """Frames that each hold their number as grey."""
    values = np.arange(first, first + count, dtype=np.uint8)
    return np.broadcast_to(values[:, None, None, None], (count, 48, 64, 3)).copy()


@pytest.fixture(scope="module", params=[".mov", ".mkv"])
def files(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> dict:
    folder = tmp_path_factory.mktemp("clips")
    found = {}
    for key, first in ((A, 0), (B, 50)):
        path = folder / f"{key.motion}{request.param}"
        write_video(path, numbered(180, first), 30.0)
        sha = hashlib.sha256(path.read_bytes()).hexdigest()
        found[key] = ClipFile(path, sha, 180, 0, 180, 64, 48)
    return found


@pytest.fixture
def decoder(files: dict) -> Iterator[Decoder]:
    made = Decoder(files.__getitem__)
    yield made
    made.close()


def test_every_frame_comes_in_order_through_a_ring_that_is_shorter(decoder: Decoder) -> None:
    for _ in range(2):  # a clip that plays twice begins again
        begun = decoder.start([A, B, A], range(180))
        for clip in begun.values():
            clip.ready()
        for k in range(180):
            assert begun[A].frame(k)[0, 0, 0] == k
            assert begun[A].frame(k)[47, 63, 2] == k  # two panels may show one clip
            assert begun[B].frame(k)[20, 20, 1] == k + 50


def test_frames_that_are_left_out_are_never_waited_for(decoder: Decoder) -> None:
    wanted = [0, 20, 40, 100, 179]
    clip = decoder.start([A], wanted)[A]
    assert [int(clip.frame(k)[0, 0, 0]) for k in wanted] == wanted


def test_a_screen_that_is_left_for_another_does_not_write_into_it(decoder: Decoder) -> None:
    for _ in range(5):
        decoder.start([A, B], range(180))[A].frame(3)
        clip = decoder.start([B], range(100))[B]
        assert [int(clip.frame(k)[0, 0, 0]) for k in range(100)] == list(range(50, 150))


def test_another_file_under_a_clips_name_is_named_before_it_is_shown(
    files: dict, tmp_path: Path
) -> None:
    path = tmp_path / "a.mov"
    path.write_bytes(files[B].path.read_bytes())
    decoder = Decoder(lambda key: files[A]._replace(path=path))
    with pytest.raises(InputError, match="exchanged"):
        decoder.start([A], range(180))[A].ready()
    decoder.close()
    decoder = Decoder(lambda key: files[A]._replace(whole=200, sha256=None))
    with pytest.raises(InputError, match="expected 200 frames, found 180"):
        decoder.start([A], range(180))[A].ready()
    decoder.close()


def test_a_decoder_that_dies_is_said_at_once(files: dict) -> None:
    decoder = Decoder(files.__getitem__)
    clip = decoder.start([A], range(180))[A]
    clip.ready()
    decoder._process.kill()
    decoder._process.wait()
    with pytest.raises(MachineError, match="--resume"):
        clip.frame(170)
    decoder.close()


def alive(pid: str) -> bool:
    """Whether a process runs; one that nobody has fetched since it ended does not."""
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return False
    return "State:\tZ" not in status


def test_nothing_is_left_of_a_decoder_whose_session_was_killed(files: dict) -> None:
    script = (
        "import sys, time\nfrom study.screen.clips import Decoder\n"
        "d = Decoder(lambda key: None)\nprint(d._process.pid, d.ring.path, flush=True)\n"
        "time.sleep(60)\n"
    )
    session = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert session.stdout is not None
    pid, ring = session.stdout.readline().split()
    session.kill()
    session.communicate()
    for _ in range(200):
        if not Path(ring).exists() and not alive(pid):
            return
        time.sleep(0.05)
    raise AssertionError(f"{pid} lives on, or {ring} is left")


@pytest.mark.parametrize("shape", [(480, 640, 3), (720, 1280, 3), (1440, 2560, 3)])
@pytest.mark.parametrize("lanes", [1, 2, 4, 8])
def test_memory_is_bounded_whatever_the_clips(shape: tuple[int, int, int], lanes: int) -> None:
    found = lanes_for([shape] * lanes, 180)
    ends = [lane.offset + lane.slots * int(np.prod(shape)) for lane in found]
    assert all(end <= lane.offset for end, lane in zip(ends, found[1:], strict=False))
    assert ends[-1] <= FIRST_BYTE + MOST_BYTES
    assert min(lane.slots for lane in found) >= 2
