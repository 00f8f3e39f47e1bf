"""Standard proportions: everybody's trunk and arms alike, legs and feet as they were captured."""

from pathlib import Path

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion import Motion, forward, load_clip, walker
from stimuli.render import Appearance
from stimuli.render.bodies import Body, make_body, rig_motion
from stimuli.render.landmarks import landmarks
from stimuli.render.proportions import ARMS, TRUNK_SHARE
from tests.conftest import of_captured

STANDARD = Appearance(style="stick", proportions="standard")
CAPTURED = Appearance(style="stick")
SHORT = {"cmu": "cmu_bvh/02_01.bvh", "rokoko": "other_bvh/rokoko_jesse_dance.bvh"}


def shares(body: Body) -> list[float]:
    """Trunk, upper arm and forearm of a body, of the stature that its legs tell."""
    marks = landmarks(body.rig.reference)
    at = marks.points
    trunk = (at["left_shoulder"] + at["right_shoulder"] - at["left_hip"] - at["right_hip"])[1] / 2
    arms = [np.linalg.norm(at[f"left_{end}"] - at[f"left_{start}"])
            for end, (start, _) in ARMS.items()]  # fmt: skip
    return [float(length) / marks.stature for length in (trunk, *arms)]


WANTED = [TRUNK_SHARE, *(share for _, share in ARMS.values())]


def check(motion: Motion) -> None:
    body, plain = make_body(motion, STANDARD), make_body(motion, CAPTURED)
    np.testing.assert_allclose(shares(body), WANTED, rtol=0.01)
    before, after = (_joints(b, motion) for b in (plain, body))
    legs = [j for side in ("left", "right") for part in ("hip", "knee", "ankle")
            for j in motion.skeleton.role(f"{side}_{part}")]  # fmt: skip
    np.testing.assert_allclose(before[:, legs], after[:, legs], atol=1e-9)
    assert np.abs(before - after).max() > 0.01


def _joints(body: Body, motion: Motion) -> np.ndarray:
    shown = body.shown(motion)
    return forward(shown.skeleton, shown.rotations, shown.root)[0]


def test_a_generated_walker_gets_them_and_keeps_its_legs() -> None:
    check(walker(0)[:6])


@pytest.mark.parametrize("name", of_captured(SHORT))
def test_captured_skeletons_get_them_and_keep_their_legs(name: str, motions: Path) -> None:
    motion = load_clip(motions / SHORT[name]).motion[:40]
    short = shares(make_body(motion, CAPTURED))
    assert np.abs(np.array(short) - WANTED).max() > 0.005
    check(motion)


def test_bodies_are_as_captured_unless_asked_for() -> None:
    motion = walker(0)[:6]
    body = make_body(motion, CAPTURED)
    assert body.shown(motion) is motion
    assert body.skeleton is motion.skeleton


def test_what_carries_the_skin_moves_with_the_longer_bones() -> None:
    motion = walker(0)[:6]
    one, other = (rig_motion(make_body(motion, look), motion) for look in (CAPTURED, STANDARD))
    assert np.abs(one - other).max() > 0.001


def test_unknown_proportions_are_refused_with_the_known_ones() -> None:
    with pytest.raises(InputError, match="captured, standard"):
        make_body(walker(0), Appearance(proportions="ideal"))
