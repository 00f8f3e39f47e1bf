"""Pictures drawn through EGL, in processes of their own: the same bytes every time."""

import json
import subprocess
import sys
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]
DRAW = """
import hashlib, json, sys
import numpy as np
from stimuli.motion import walker
from pathlib import Path
from stimuli.render import Appearance, decode_video, render_frames, write_clip
look = Appearance(**json.loads(sys.argv[2]))
frames = np.array(list(render_frames(walker(0)[:3], look)))
np.save(sys.argv[1], frames)
clip = Path(sys.argv[1]).with_suffix(".mkv")
assert write_clip(walker(0)[:3], clip, look) == 3
np.testing.assert_array_equal(decode_video(clip), frames)
assert "psychopy" not in sys.modules
"""


def draw(directory: Path, name: str, **look: object) -> np.ndarray:
    """Three frames of the walker, drawn by a new process."""
    path = directory / f"{name}.npy"
    subprocess.run(
        [sys.executable, "-W", "error", "-c", DRAW, str(path), json.dumps(look)],
        cwd=ROOT, check=True, timeout=120,
    )  # fmt: skip
    return np.asarray(np.load(path))


@lru_cache(maxsize=1)
def pictures(directory: Path) -> np.ndarray:
    return draw(directory, "first", width=160, height=120, camera="fixed", style="mannequin")


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> np.ndarray:
    return pictures(tmp_path_factory.mktemp("drawn"))


def test_another_process_draws_the_same_bytes_and_writes_them_to_its_clip(
    drawn: np.ndarray, tmp_path: Path
) -> None:
    again = draw(tmp_path, "second", width=160, height=120, camera="fixed", style="mannequin")
    np.testing.assert_array_equal(again, drawn)


def test_the_figure_stands_whole_before_a_plain_background(drawn: np.ndarray) -> None:
    assert drawn.shape == (3, 120, 160, 3)
    figure = np.any(drawn != 128, axis=-1)
    assert not figure[:, 0].any()
    assert not figure[:, -1].any()
    assert not figure[:, :, 0].any()
    assert not figure[:, :, -1].any()
    assert 0.02 < figure.mean() < 0.5
    tall = np.flatnonzero(figure[0].any(axis=1))
    assert tall[-1] - tall[0] > 0.6 * 120


def test_nothing_is_clipped_to_white_or_black(drawn: np.ndarray) -> None:
    assert drawn.max() < 250
    assert drawn.min() > 15


def test_edges_are_antialiased(drawn: np.ndarray) -> None:
    lit = drawn[drawn[..., 0] != 128]
    assert len(np.unique(lit[:, 0])) > 30


def test_background_colour_and_body_are_settings(tmp_path: Path) -> None:
    frames = draw(
        tmp_path, "other", width=96, height=96, camera="fixed", background=[0.2, 0.4, 0.6]
    )
    assert tuple(frames[0, 0, 0]) == (51, 102, 153)
    assert np.any(frames[0] != frames[0, 0, 0])
