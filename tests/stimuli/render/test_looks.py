"""Styles, grounds, samples and tints as they are drawn, by one new process for them all."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from stimuli.motion import walker
from stimuli.render import Appearance
from stimuli.render.bodies import STYLES, make_body
from stimuli.render.light import LUMINANCE, tinted

ROOT = Path(__file__).resolve().parents[3]
SIZE = {"width": 200, "height": 150, "camera": "follow", "style": "mannequin"}
LOOKS = {
    **{style: {"style": style} for style in STYLES},
    "shadow": {"ground": "shadow"},
    "grid": {"ground": "grid"},
    "dotted": {"style": "point-light", "ground": "grid"},
    "supersampled": {"style": "stick", "supersample": 3},
    "tinted": {"tint": 1.0},
    "large dots": {"style": "point-light", "dot_size": 1.0},
    "metres": {"style": "point-light", "dot_size": 0.1, "dot_unit": "metres"},
    "thick": {"style": "stick", "thickness": 2.0},
}
DRAW = """
import json, sys
import numpy as np
from stimuli.motion import walker
from stimuli.motion.kinematics import placed
from stimuli.render import Appearance
from stimuli.render.bodies import bone_motion, make_body
from stimuli.render.clip import ground_motions
from stimuli.render.scene import renderer
from stimuli.render.staging import choose_camera, stage
one = walker(0)[:8]
other = placed(one, 0.0, np.array([0.0, 0.0, 0.3]))
found = {}
for name, settings in json.loads(sys.argv[2]).items():
    look = Appearance(**settings)
    body = make_body(one, look)
    bones = [bone_motion(body, motion) for motion in (one, other)]
    camera = choose_camera(stage(body, [one, other], bones, 4), look)
    grounds = ground_motions(body, [one, other], bones, look)
    with renderer(look) as drawing:
        drawing.show(body.skin, camera)
        found[name] = np.stack([
            drawing.draw(bones[k], frame, grounds[k]) for k in (0, 1) for frame in (0, 4)
        ])
np.savez(sys.argv[1], **found)
"""


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> dict[str, np.ndarray]:
    """Of each look, frames 0 and 4 of two clips of a group, (4, height, width, 3)."""
    path = tmp_path_factory.mktemp("looks") / "drawn.npz"
    looks = {name: SIZE | settings for name, settings in LOOKS.items()}
    subprocess.run(
        [sys.executable, "-W", "error", "-c", DRAW, str(path), json.dumps(looks)],
        cwd=ROOT, check=True, timeout=240,
    )  # fmt: skip
    return {name: pictures.astype(int) for name, pictures in np.load(path).items()}


def shown(picture: np.ndarray) -> np.ndarray:
    return np.any(picture != 128, axis=-1)


@pytest.mark.parametrize("style", STYLES)
def test_every_style_is_drawn_whole_before_the_exact_background(drawn, style: str) -> None:
    figure = shown(drawn[style][0])
    assert figure.any()
    edge = np.concatenate([figure[0], figure[-1], figure[:, 0], figure[:, -1]])
    assert not edge.any()
    rows = np.flatnonzero(figure.any(axis=1))
    assert np.ptp(rows) > 0.5 * 150
    assert drawn[style].max() < 250


def test_styles_cover_the_less_of_the_picture_the_less_they_have(drawn) -> None:
    share = [shown(drawn[style][0]).mean() for style in ("mannequin", "stick", "point-light")]
    assert share[0] > 1.5 * share[1] > 1.5 * 1.5 * share[2]
    assert shown(drawn["thick"][0]).mean() > 1.3 * share[1]


def test_a_ground_darkens_only_around_the_feet_and_nothing_above(drawn) -> None:
    plain = drawn["mannequin"][0]
    for ground in ("shadow", "grid"):
        picture = drawn[ground][0]
        differs = np.any(picture != plain, axis=-1)
        assert differs.any()
        bare = differs & ~shown(plain)
        assert np.all(picture[bare] < 128)
        assert not differs[:75].any()  # the upper half of the picture
    spread = [np.any(drawn[g][0] != plain, axis=-1).sum() for g in ("shadow", "grid")]
    assert spread[1] > spread[0] > 20


def test_the_background_is_exact_outside_the_ground(drawn) -> None:
    for ground in ("shadow", "grid", "dotted"):
        values, counts = np.unique(drawn[ground][0].reshape(-1, 3), axis=0, return_counts=True)
        assert tuple(values[counts.argmax()]) == (128, 128, 128)
        assert counts.max() > 0.4 * 200 * 150
        assert not shown(drawn[ground][0])[:70, :20].any()


def test_a_followed_ground_is_the_same_for_all_clips_of_a_group_and_goes_by(drawn) -> None:
    """Points of light hide nothing: what is left of the picture is the floor."""
    one, later, other, _ = drawn["dotted"]
    dots = (one > 128).any(axis=-1) | (other > 128).any(axis=-1)
    np.testing.assert_array_equal(one[~dots], other[~dots])
    floor = ~dots & ~(later > 128).any(axis=-1)
    assert np.any(one[floor] != later[floor])
    assert np.any(one[floor] < 128)


def test_dots_have_the_size_that_was_asked_for(drawn) -> None:
    """One degree where the picture's 150 pixels are 20: seven and a half pixels across."""
    first = drawn["large dots"][0]
    area = ((first - 128).max(axis=-1) / (first - 128).max()).sum() / 13
    degrees = 2 * np.sqrt(area / np.pi) / 150 * 20
    assert degrees == pytest.approx(1.0, rel=0.1)
    assert shown(drawn["metres"][0]).sum() > 1.5 * shown(drawn["point-light"][0]).sum()


def test_supersampled_edges_have_more_shades(drawn) -> None:
    edges = [len(np.unique(drawn[name][0].reshape(-1, 3), axis=0)) for name in
             ("stick", "supersampled")]  # fmt: skip
    assert edges[1] > 1.05 * edges[0]
    assert abs(drawn["supersampled"][0].mean() - drawn["stick"][0].mean()) < 0.5


def test_a_tint_tells_left_from_right_and_is_as_bright(drawn) -> None:
    red, _, blue = np.moveaxis(drawn["tinted"][0], -1, 0)
    assert (blue - red).max() > 15
    assert (red - blue).max() > 50
    plain, left, right = tinted((0.6, 0.6, 0.6), np.array([0.0, 1.0, -1.0]), 1.0) @ LUMINANCE
    assert left == pytest.approx(plain)
    assert right == pytest.approx(plain)


def test_left_limbs_are_at_the_left() -> None:
    skin = make_body(walker(0), Appearance(style="stick")).skin
    assert np.all(skin.points[skin.sides > 0.9, 0] > 0)
    assert np.all(skin.points[skin.sides < -0.9, 0] < 0)
