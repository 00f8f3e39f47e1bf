"""What names a clip: everything that shows, nothing that a processor or a folder decides."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stimuli.motion import Library, Motion
from stimuli.motion import quaternions as quat
from stimuli.motion.formats.bvh_write import write_bvh
from stimuli.sets import SetSpec, build, naming, resolve
from stimuli.sets.group import plan_group
from stimuli.sets.naming import GRID, motion_digest, same_pictures
from stimuli.transition import transition, with_room
from tests.stimuli.sets import recipe

KEPT = json.loads(recipe.KEPT.read_text(encoding="utf-8"))
RAISE = "What clips show has changed: raise RECIPE in stimuli/sets/naming.py"


def names(spec: SetSpec, library: Library) -> list[str]:
    return [
        clip.hash
        for resolved in resolve(spec, library)
        for clip in plan_group(spec, resolved, library).clips
    ]


def test_a_recipe_s_clips_show_what_they_showed() -> None:
    assert KEPT["recipe"] == naming.RECIPE, "python -m tests.stimuli.sets.recipe"
    assert recipe.differing(KEPT["figures"], recipe.figures()) == [], RAISE


def test_a_recipe_s_pictures_look_as_they_looked() -> None:
    np.testing.assert_allclose(recipe.shades(), KEPT["shades"], atol=recipe.SHADES, err_msg=RAISE)


def test_what_shows_changes_the_figures() -> None:
    figures = recipe.figures()
    assert recipe.differing(figures, dict(figures)) == []
    first = next(iter(figures))
    assert recipe.differing(figures, figures | {first: figures[first] + 1e-5}) == [first]
    assert recipe.differing(figures, figures | {"another": 0.0}) == ["another"]
    stand = np.zeros((100, 15, 3))
    moved = stand.copy()
    moved[50:53, 4, 1] += 1e-3  # a millimetre of one joint over a tenth of a second
    assert abs(recipe.figure(moved) - recipe.figure(stand)) > recipe.SAME


@pytest.fixture(scope="module")
def once(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the set is built once."""
    return tmp_path_factory.mktemp("once")


@pytest.mark.parametrize("written", ["stem", "suffix", "folder", "path"])
def test_no_name_and_no_set_s_hash_knows_of_a_path(
    spec: SetSpec, library: Library, once: Path, tmp_path: Path, written: str
) -> None:
    """Clips called by stem, file name, folder or path, in a library moved elsewhere."""
    elsewhere = tmp_path / "else" / "where"
    shutil.copytree(library.directories[0], elsewhere)
    moved = Library([tmp_path / "else"])

    def called(stem: str) -> str:
        path = next(elsewhere.glob(f"{stem}.*"))
        return {"stem": stem, "suffix": path.name, "folder": f"where/{stem}", "path": str(path)}[
            written
        ]

    (pairing,) = spec.pairings
    there = replace(
        pairing, from_clip=called(pairing.from_clip), to_clip=called(pairing.to_clip)
    )  # fmt: skip
    one = build(spec, library, once)
    shutil.copytree(once / "clips", tmp_path / "other" / "clips")
    other = build(replace(spec, pairings=(there,)), moved, tmp_path / "other")
    assert other.rendered == 0
    assert [clip.hash for clip in other.clips] == [clip.hash for clip in one.clips]
    assert other.hash == one.hash


@pytest.mark.parametrize(
    "change",
    [
        {"smooth": True}, {"foot_lock": True}, {"seconds": 0.6}, {"fps": 31}, {"longer": (3, 5)},
        {"specification": "start-end"}, {"reference": 7}, {"from_frame": 13}, {"to_frame": 21},
        {"to_clip": "generated-walker-2"}, {"background": (0.5, 0.5, 0.6)}, {"direction": 36.0},
        {"width": 98}, {"style": "figure"},
        {"ground": "grid"}, {"tint": 0.5}, {"foot_roll": 20.0}, {"camera": "follow"},
        {"supersample": 2},
    ],
    ids=str,
)  # fmt: skip
def test_what_shows_gives_every_clip_a_new_name(
    spec: SetSpec, library: Library, change: dict[str, object]
) -> None:
    (pairing,) = spec.pairings
    parts = {spec: {}, pairing: {}, spec.appearance: {}}  # type: ignore[var-annotated]
    for key, value in change.items():
        next(kept for part, kept in parts.items() if hasattr(part, key))[key] = value
    changed = replace(
        spec,
        pairings=(replace(pairing, **parts[pairing]),),
        appearance=replace(spec.appearance, **parts[spec.appearance]),
        **parts[spec],
    )
    before = names(spec, library)
    assert before == names(replace(spec, name="other"), library)
    assert not set(before) & set(names(changed, library))


def test_a_new_recipe_gives_every_clip_a_new_name(
    spec: SetSpec, library: Library, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = names(spec, library)
    monkeypatch.setattr(naming, "RECIPE", naming.RECIPE + 1)
    assert not set(before) & set(names(spec, library))


def test_a_length_of_another_group_leaves_the_rest_as_they_are(
    spec: SetSpec, library: Library
) -> None:
    (pairing,) = spec.pairings
    second = replace(pairing, name="second", from_frame=3)
    both = replace(spec, pairings=(pairing, second))
    assert names(both, library)[:4] == names(spec, library)
    assert len(set(names(both, library))) == 8


def test_rounding_gives_a_motion_no_other_name_and_what_is_seen_does(library: Library) -> None:
    motion = library.load("generated-walker-0").motion
    rng = np.random.default_rng(7)
    for _ in range(20):
        noise = 1e-15 * rng.standard_normal(motion.rotations.shape)
        flips = rng.choice([-1.0, 1.0], motion.rotations.shape[:2])[..., None]
        near = replace(
            motion, rotations=flips * quat.normalise(motion.rotations + noise),
            root=motion.root + 1e-15 * rng.standard_normal(motion.root.shape),
        )  # fmt: skip
        assert motion_digest(near) == motion_digest(motion)
    for frame, joint in ((0, 3), (17, 9)):
        turned = motion.rotations.copy()
        turned[frame, joint] = quat.multiply(turned[frame, joint], quat.about("X", 0.002))
        assert motion_digest(replace(motion, rotations=turned)) != motion_digest(motion)
    higher = motion.root + np.array([0.0, 0.001, 0.0])
    assert motion_digest(replace(motion, root=higher)) != motion_digest(motion)
    longer = replace(motion.skeleton, offsets=motion.skeleton.offsets * 1.002)
    assert motion_digest(replace(motion, skeleton=longer)) != motion_digest(motion)
    assert motion_digest(replace(motion, cycle=None)) != motion_digest(motion)


def test_a_motion_written_and_read_again_has_its_name(library: Library, tmp_path: Path) -> None:
    """Other line ends and another folder are no other motion."""
    loop = library.load("generated-walker-0").motion
    write_bvh(Motion(loop.skeleton, loop.rotations, loop.root), tmp_path / "a.bvh")
    crlf = tmp_path / "elsewhere" / "b.bvh"
    crlf.parent.mkdir()
    crlf.write_bytes((tmp_path / "a.bvh").read_bytes().replace(b"\n", b"\r\n"))
    one, other = (Library([path.parent]).load(path) for path in (tmp_path / "a.bvh", crlf))
    assert one.sha256 != other.sha256
    assert motion_digest(one.motion) == motion_digest(other.motion)


@given(st.integers(-(10**9), 10**9), st.integers(0, 6))
def test_no_written_number_lies_at_an_edge_of_the_grid(whole: int, decimals: int) -> None:
    """An edge is an odd multiple of 2⁻¹³: from k/10⁶ it is a multiple of 10⁻¹³ away, never 0."""
    from fractions import Fraction

    cells = Fraction(whole, 10**decimals) / Fraction(GRID)
    beyond = cells - (cells.numerator // cells.denominator) - Fraction(1, 2)
    assert abs(beyond) * Fraction(GRID) >= Fraction(1, 10**13)


def test_axes_are_those_of_the_rotation() -> None:
    turns = quat.exp(np.random.default_rng(1).normal(0, 1, (50, 3)))
    for q in (turns, -turns):
        np.testing.assert_allclose(quat.axes(q)[:, :3], quat.rotate(q, np.eye(3)[0]), atol=1e-12)
        np.testing.assert_allclose(quat.axes(q)[:, 3:], quat.rotate(q, np.eye(3)[1]), atol=1e-12)


def test_clips_that_nobody_could_tell_apart_are_one(library: Library) -> None:
    a, i = with_room(library.load("generated-walker-0").motion, 12)
    b, j = with_room(library.load("generated-walker-1").motion, 20)
    made = [transition(a, b, i, j, frames=frames).motion[:150] for frames in (8, 9)]
    nudged = replace(made[1], root=made[1].root + 1e-9)
    lifted = replace(made[1], root=made[1].root + 1e-3)
    assert same_pictures([*made, nudged, made[0], lifted]) == [0, 1, 1, 0, 4]
