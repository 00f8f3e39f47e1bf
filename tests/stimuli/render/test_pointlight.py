"""Point-light walkers: where their dots are, and what their controls keep and disturb."""

from functools import lru_cache

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion import Motion, forward, unroll, walker
from stimuli.render import Appearance
from stimuli.render.bodies import bone_motion, make_body
from stimuli.render.pointlight import CONTROLS

KNEES = 8  # head, then pairs of shoulders, elbows, wrists, hips, knees, ankles
COUNT = 13


@lru_cache(maxsize=1)
def walking() -> Motion:
    long, _ = unroll(walker(0), 0, 90)
    return long[:90]


def dots(motion: Motion | None = None, **settings: object) -> np.ndarray:
    """(F, D, 3) places of the dots."""
    motion = motion or walking()
    look = Appearance(style="point-light", **settings)  # type: ignore[arg-type]
    bones = bone_motion(make_body(walking(), look), motion)
    np.testing.assert_array_equal(
        bones[..., :4], np.broadcast_to([1, 0, 0, 0], (*bones.shape[:2], 4))
    )
    return 2 * bones[..., 5:].astype(float)


def test_dots_are_at_the_joints() -> None:
    found = dots()
    assert found.shape == (90, COUNT, 3)
    motion = walking()
    positions, _ = forward(motion.skeleton, motion.rotations, motion.root)
    knees = positions[:, motion.skeleton.role("left_knee", "right_knee")]
    np.testing.assert_allclose(found[:, 9:11], knees, atol=1e-4)
    assert np.all(found[:, 0, 1] > found[:, 1:, 1].max(axis=1))


def test_places_are_a_setting() -> None:
    assert dots(dots=("wrists", "pelvis")).shape == (90, 3, 3)
    for places, told in (((), "found none"), (("nose",), "'nose'")):
        with pytest.raises(InputError, match=told):
            dots(dots=places)


def test_scrambled_dots_move_as_they_did_from_other_places() -> None:
    plain, scrambled = dots(), dots(control="scrambled")
    moved = scrambled - plain
    np.testing.assert_allclose(moved, np.broadcast_to(moved[:1], moved.shape), atol=1e-5)
    assert np.linalg.norm(moved[0], axis=-1).min() > 0.01
    tall = np.ptp(plain[..., 1])
    assert np.ptp(scrambled[0, :, 1]) < 1.3 * tall
    again = dots(control="scrambled")
    np.testing.assert_array_equal(again, scrambled)
    assert np.any(dots(control="scrambled", control_seed=1) != scrambled)


def test_clips_of_a_group_are_scrambled_alike() -> None:
    part = walking()[:40]
    np.testing.assert_allclose(
        dots(part, control="scrambled"), dots(control="scrambled")[:40], atol=1e-6
    )
    np.testing.assert_allclose(
        dots(part, control="inverted"), dots(control="inverted")[:40], atol=1e-6
    )


def test_inverted_dots_stand_on_their_head() -> None:
    plain, inverted = dots(), dots(control="inverted")
    np.testing.assert_allclose(inverted[..., [0, 2]], plain[..., [0, 2]], atol=1e-6)
    total = inverted[..., 1] + plain[..., 1]
    np.testing.assert_allclose(total, total[0, 0], atol=1e-5)
    assert inverted[0, 0, 1] < inverted[0, 1:, 1].min()
    assert np.ptp(inverted[..., 1]) == pytest.approx(np.ptp(plain[..., 1]), abs=1e-5)


def test_phase_scrambled_dots_go_through_the_same_places_at_other_times() -> None:
    plain, shifted = dots(), dots(control="phase-scrambled")
    low, high = plain[..., 1].min(axis=0), plain[..., 1].max(axis=0)
    assert np.all((shifted[..., 1] > low - 0.05) & (shifted[..., 1] < high + 0.05))
    assert np.abs(shifted - plain)[:, 7:].max() > 0.1
    about, other = (places - walking().root[:, None] for places in (plain, shifted))
    step = np.abs(np.diff(other, axis=0)).max()
    assert step < 1.2 * np.abs(np.diff(about, axis=0)).max()


def test_an_unknown_control_is_refused_with_the_known_ones() -> None:
    with pytest.raises(InputError, match=", ".join(CONTROLS)):
        dots(control="mirrored")
