"""One camera for a group: which direction, which kind, which shape; and how large the figure is."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion import Motion, unroll, walker
from stimuli.motion.kinematics import placed
from stimuli.render import Appearance
from stimuli.render.bodies import bone_motion, make_body
from stimuli.render.staging import (
    ANYWHERE,
    CAMERAS,
    NEAR_BLEND,
    Staging,
    choose_camera,
    settle,
    sizes,
    smoothed,
    stage,
)

LOOK = Appearance(width=640, height=360, style="mannequin")
TALL = 1.7


def going(way: np.ndarray, *, near: slice = slice(None), heading: float = 0.0) -> Staging:
    """A box as large as a body that goes along `way` (F, 2), x and z."""
    corners = np.array([[x, y, z] for x in (-0.3, 0.3) for y in (0, TALL) for z in (-0.3, 0.3)])
    at = np.stack([way[:, 0], np.zeros(len(way)), way[:, 1]], axis=-1)
    outlines = (corners + at[:, None]).astype(np.float32)
    close = np.zeros(len(way), dtype=bool)
    close[near] = True
    return Staging(
        outlines,
        at + np.array([0, 0.9, 0]),
        np.arange(len(way)),
        close,
        smoothed(way, 30),
        heading,
        TALL,
    )


def straight(metres: float, frames: int = 180) -> np.ndarray:
    return np.stack([np.zeros(frames), np.linspace(0, metres, frames)], axis=-1)


def walking(count: int = 60) -> Motion:
    long, _ = unroll(walker(0), 0, count)
    return long[:count]


def group(*motions: Motion, look: Appearance = LOOK) -> Staging:
    body = make_body(motions[0], look)
    return stage(body, motions, [bone_motion(body, m) for m in motions], 20, None)


def in_frame(camera, staging: Staging, look: Appearance) -> bool:
    seen = camera.seen(staging.outlines, staging.frames)
    focal = 0.5 / np.tan(camera.field_of_view / 2)
    depth = -seen[..., 2]
    aspect = look.width / look.height
    return bool(
        np.all(depth > 0)
        and np.all(np.abs(seen[..., 0] / depth * focal) <= aspect / 2 * (1 - look.margin))
        and np.all(np.abs(seen[..., 1] / depth * focal) <= 0.5 * (1 - look.margin))
    )


@pytest.mark.parametrize("kind", CAMERAS)
@pytest.mark.parametrize("direction", [0.0, 70.0, 180.0])
def test_every_camera_holds_everything_at_the_direction_asked_for(
    kind: str, direction: float
) -> None:
    staging = going(straight(5.0, 90), heading=0.4)
    look = replace(LOOK, camera=kind, direction=direction)
    camera = choose_camera(staging, look)
    assert camera.kind == kind
    assert in_frame(camera, staging, look)
    off = camera.yaw - 0.4 - np.radians(direction)
    assert np.arctan2(np.sin(off), np.cos(off)) == pytest.approx(0, abs=1e-3)
    assert sizes(camera, staging).middle == pytest.approx(0.5, abs=0.06)


def test_a_standing_figure_is_seen_from_the_front_and_from_aside() -> None:
    camera = choose_camera(going(straight(0.0, 30), heading=1.0), replace(LOOK, camera="fixed"))
    assert np.degrees(abs(camera.yaw - 1.0)) == pytest.approx(40, abs=0.1)


def test_the_direction_is_the_one_from_which_the_least_is_largest() -> None:
    staging = going(straight(6.0))
    look = replace(LOOK, camera="fixed")
    chosen = sizes(choose_camera(staging, look), staging).enough
    tried = [
        sizes(choose_camera(staging, replace(look, direction=float(d))), staging).enough
        for d in range(0, 360, 30)
    ]
    assert chosen >= 0.9 * max(tried)
    assert min(tried) < 0.9 * chosen


def test_a_pan_turns_after_a_walk_and_shows_it_larger_than_a_fixed_camera() -> None:
    staging = going(straight(8.0))
    fixed, pan = (
        choose_camera(staging, replace(LOOK, camera=kind, direction=90.0))
        for kind in ("fixed", "pan")
    )
    assert sizes(pan, staging).anywhere > 1.2 * sizes(fixed, staging).anywhere
    turns = np.array(pan.moves)[:, 2]
    assert np.ptp(turns) > 0.3
    assert np.all(np.abs(np.diff(turns)) < 0.02)
    np.testing.assert_array_equal(np.array(pan.moves)[:, :2], 0)


def test_a_followed_path_is_the_smoothed_mean_of_the_group() -> None:
    one = walking()
    other = placed(one, 0.0, np.array([0.2, 0.0, 0.1]))
    staging = group(one, other)
    camera = choose_camera(staging, replace(LOOK, camera="follow"))
    mean = (one.root + other.root)[:, [0, 2]] / 2
    np.testing.assert_allclose(np.array(camera.moves)[:, :2], smoothed(mean, 30), atol=1e-5)
    assert np.abs(np.diff(np.array(camera.moves)[:, :2], n=2, axis=0)).max() < 5e-4


def test_a_straight_way_stays_as_it_is_when_smoothed() -> None:
    np.testing.assert_allclose(smoothed(straight(3.0, 50), 30), straight(3.0, 50), atol=1e-9)


def test_equal_frames_of_a_group_count_once() -> None:
    staging = group(walking(), walking(), walking())
    assert len(staging.frames) == 60
    assert len(group(walking(), placed(walking(), 0.1, np.zeros(3))).frames) > 60


def test_auto_takes_a_fixed_camera_where_it_shows_enough() -> None:
    look = Appearance(camera="auto")
    settled = settle(look, [going(straight(2.0))])
    assert (settled.look.camera, settled.look.ground, settled.remarks) == ("fixed", "none", ())
    assert sizes(settled.cameras[0], going(straight(2.0))).enough >= 1


def test_auto_follows_runs_over_a_grid_in_the_whole_study_and_says_so() -> None:
    groups = [going(straight(2.0)), going(straight(13.0))]
    settled = settle(Appearance(camera="auto"), groups)
    assert settled.look.camera == "follow"
    assert settled.look.ground == "grid"
    assert all(camera.kind == "follow" for camera in settled.cameras)
    (remark,) = settled.remarks
    assert "follow" in remark
    assert "0.2" in remark
    for camera, staging in zip(settled.cameras, groups, strict=True):
        shown = sizes(camera, staging)
        assert shown.near_blend >= NEAR_BLEND
        assert shown.anywhere >= ANYWHERE
    kept = settle(Appearance(camera="auto", ground="shadow"), groups)
    assert kept.look.ground == "shadow"


def test_the_best_shape_is_wide_for_a_walk_across_and_narrow_side_by_side() -> None:
    across = [going(straight(4.0))]
    assert settle(Appearance(camera="fixed"), across).look.width == 1280
    still = [going(straight(0.0, 20))]
    assert settle(Appearance(camera="fixed"), still, beside=2).look.width == 960


def test_the_whole_motion_of_a_body_is_in_the_picture(sample_walk: Motion) -> None:
    staging = group(sample_walk)
    for kind in CAMERAS:
        look = replace(LOOK, camera=kind)
        assert in_frame(choose_camera(staging, look), staging, look)


@pytest.fixture
def sample_walk(tmp_path: Path) -> Motion:
    """A walk of two seconds."""
    return walking(60)


@pytest.mark.parametrize(
    ("change", "told"),
    [({"camera": "drone"}, "fixed, pan, follow"), ({"shape": "1:1", "width": 0}, "4:3, 16:9")],
)
def test_an_unknown_camera_or_shape_is_refused_with_the_known_ones(change, told) -> None:
    with pytest.raises(InputError, match=told):
        settle(replace(LOOK, **change), [going(straight(1.0, 10))])
