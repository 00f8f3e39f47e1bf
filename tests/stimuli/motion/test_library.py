"""Clips found by name, sample motions, the generated walker, loops."""

import hashlib
import json
import shutil
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion import (
    Library,
    Motion,
    end_positions,
    forward,
    load_clip,
    motion_directories,
    samples,
    unroll,
    walker,
    write_walker,
)
from stimuli.motion.kinematics import headings


def points(motion: Motion) -> np.ndarray:
    positions, orientations = forward(motion.skeleton, motion.rotations, motion.root)
    ends = end_positions(motion.skeleton, positions, orientations)
    return np.concatenate([positions, ends], axis=1)


def test_clips_are_found_by_stem_and_by_path(tmp_path):
    first, second = tmp_path / "a", tmp_path / "b" / "deep"
    path = write_walker(first, 0)
    write_walker(second, 1)
    (first / "notes.txt").write_text("nothing of a clip")
    library = Library([first, tmp_path / "b"])
    assert [p.stem for p in library.paths()] == ["generated-walker-0", "generated-walker-1"]
    assert library.find("generated-walker-0") == path
    assert library.find(str(path)) == path
    assert library.find("generated-walker-0.json") == path
    assert library.find("a/generated-walker-0") == path
    assert library.load("generated-walker-1") is library.load("generated-walker-1")
    write_walker(second, 0)
    with pytest.raises(InputError, match="found 2"):
        Library([first, tmp_path / "b"]).find("generated-walker-0")
    assert Library([first, tmp_path / "b"]).find("a/generated-walker-0") == path
    with pytest.raises(InputError, match="found none"):
        library.find("../../generated-walker-9")
    with pytest.raises(InputError, match="nothing there"):
        Library([tmp_path / "c"]).paths()


def test_where_clips_are_looked_for(tmp_path, monkeypatch):
    monkeypatch.setenv("SEGUE_MOTIONS", f"{tmp_path / 'x'}:{tmp_path / 'y'}")
    assert motion_directories([tmp_path]) == [tmp_path]
    assert motion_directories(None) == [tmp_path / "x", tmp_path / "y"]
    monkeypatch.delenv("SEGUE_MOTIONS")
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    assert motion_directories(None) == []


def wheel_of(tmp_path: Path, monkeypatch) -> Path:
    """A small wheel laid out as the pinned one, which `fetch` is made to take for it."""
    wheel = tmp_path / "sample.whl"
    text = write_walker(tmp_path / "made", 0).read_text()
    dog = json.dumps({"Loop": "wrap", "Frames": [[0.1] * 20]})
    folder = "pybullet_data/data/motions/"
    with zipfile.ZipFile(wheel, "w") as archive:
        archive.writestr(folder + "humanoid3d_walk.txt", text)
        archive.writestr(folder + "walker/turn.txt", text)
        archive.writestr(folder + "laikago_walk.txt", dog)
        archive.writestr("pybullet-3.2.7.dist-info/LICENSE.txt", "zlib")
        archive.writestr("pybullet_data/../../evil.txt", "x")
    monkeypatch.setattr(samples, "_download", lambda temporary: wheel)
    return wheel


def test_of_the_wheel_only_the_clips_of_the_humanoid_are_kept(tmp_path, monkeypatch):
    wheel = wheel_of(tmp_path, monkeypatch)
    monkeypatch.setattr(samples, "SHA256", hashlib.sha256(wheel.read_bytes()).hexdigest())
    kept = samples.fetch(tmp_path / "library")
    assert [path.name for path in kept] == ["humanoid3d_walk.json", "turn.json"]
    assert sorted(p.name for p in (tmp_path / "library").iterdir()) == [
        "SOURCE.md", "humanoid3d_walk.json", "turn.json"]  # fmt: skip
    assert load_clip(kept[0]).motion.loop


def test_another_wheel_is_refused_and_nothing_kept(tmp_path, monkeypatch):
    wheel_of(tmp_path, monkeypatch)
    with pytest.raises(InputError, match="SHA-256"):
        samples.fetch(tmp_path / "library")
    assert not (tmp_path / "library").exists()


def test_no_network_is_an_os_error_that_says_what_to_do(tmp_path, monkeypatch):
    monkeypatch.setenv("PIP_INDEX_URL", "http://127.0.0.1:9/simple")
    monkeypatch.setenv("PIP_RETRIES", "0")
    with pytest.raises(OSError, match="cannot be downloaded"):
        samples.fetch(tmp_path / "library")
    assert not (tmp_path / "library").exists()


def test_the_walker_is_labelled_deterministic_and_walks(tmp_path):
    path = write_walker(tmp_path, 3)
    assert path.name == "generated-walker-3.json"
    assert "not captured" in json.loads(path.read_text())["Note"]
    assert write_walker(tmp_path / "again", 3).read_bytes() == path.read_bytes()
    assert write_walker(tmp_path, 4).read_bytes() != path.read_bytes()
    motion, _ = unroll(walker(3), 0, 60)
    all_points = points(motion)
    assert -0.01 < all_points[..., 1].min() < 0.02
    assert all_points[..., 1].max() > 1.4
    assert 0.8 < (motion.root[-1, 0] - motion.root[0, 0]) / motion.seconds < 1.6
    knees = motion.skeleton.role("left_knee", "right_knee")
    assert np.all(motion.rotations[:, knees, 3] < 0)


def test_the_walkers_standing_foot_stays(tmp_path):
    from stimuli.transition.plants import contacts, leg_pose

    motion, _ = unroll(walker(0), 0, 60)
    pose, stands = leg_pose(motion, slice(None)), contacts(motion).stands
    flat = np.linalg.norm(np.diff(pose.ankle, axis=0), axis=-1) < 0.003
    assert flat.mean() > 0.15
    assert np.all(stands[1:][flat])


@pytest.mark.parametrize(
    "name", ["humanoid3d_walk", "humanoid3d_run", "humanoid3d_cartwheel", "humanoid3d_spinkick",
             "turn_left1", "humanoid3d_dance_b"],
)  # fmt: skip
def test_loops_unroll_without_a_seam(sample_motions, name):
    motion = load_clip(sample_motions / f"{name}.json").motion
    longer, shift = unroll(motion, 40, 150)
    assert shift >= 40
    assert len(longer) - shift - len(motion) >= 149
    places = points(longer)
    speed = np.linalg.norm(np.diff(places, axis=0), axis=-1).max(axis=1)
    jolt = np.linalg.norm(np.diff(places, 2, axis=0), axis=-1).max(axis=1)
    seams = [round(shift + k * motion.cycle.period) for k in (-1, 0, 1, 2)]
    within = np.ones(len(jolt), dtype=bool)
    for seam in (s for s in seams if 2 < s < len(jolt) - 2):
        within[seam - 3 : seam + 2] = False
    for seam in (s for s in seams if 2 < s < len(jolt) - 2):
        assert (
            speed[seam - 2 : seam + 2].max()
            <= 1.1 * speed[within[: len(speed) - 1].nonzero()].max()
        )
        assert jolt[seam - 3 : seam + 2].max() <= jolt[within].max()
    middle = len(motion) // 2
    assert np.allclose(places[shift + middle], points(motion)[middle], atol=1e-6)


def test_displacement_and_heading_of_a_cycle_accumulate(sample_motions):
    motion = load_clip(sample_motions / "turn_left1.json").motion
    cycle = motion.cycle
    longer, shift = unroll(motion, 0, 120)
    assert shift == 0
    period = round(cycle.period)
    middles = 18 + period * np.arange(4)
    turned = np.diff(np.unwrap(headings(longer)[middles]))
    assert np.allclose(turned, cycle.yaw, atol=1e-6)
    assert abs(np.degrees(cycle.yaw)) > 30
    steps = np.linalg.norm(np.diff(longer.root[middles], axis=0), axis=1)
    assert np.allclose(steps, steps[0], atol=1e-6)


def test_what_is_no_loop_or_needs_no_more_stays_as_it_is(bodies):
    plain = bodies.wandering(20, 1)
    assert unroll(plain, 50, 50) == (plain, 0)
    loop = walker(0)
    assert unroll(loop, 0, 0) == (loop, 0)
    assert not loop[3:9].loop


def test_a_name_longer_than_any_file_s_is_not_found(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="found none"):
        Library([tmp_path]).find("a" * 300)


def test_one_file_under_any_name_is_one_clip_and_its_copies_share_one_motion(tmp_path, monkeypatch):
    path = write_walker(tmp_path / "a", 0)
    other = write_walker(tmp_path / "b", 0)
    monkeypatch.chdir(tmp_path)
    library = Library([tmp_path / "a"])
    clip = library.load(path)
    for name in (path.stem, path.relative_to(tmp_path), f"b/../a/{path.name}"):
        assert library.load(name) is clip
    copy = library.load(other)
    assert (copy.path, copy.name) == (other, clip.name)
    assert copy.motion is clip.motion
    scaled = tmp_path / "c" / path.name
    scaled.parent.mkdir()
    shutil.copy(path, scaled)
    (tmp_path / "c" / "overrides.toml").write_text("scale = 2.0")
    assert library.load(scaled).motion is not clip.motion


def test_the_same_motion_is_told_from_any_other(bodies):
    motion, loop = bodies.wandering(20, 1), walker(0)
    assert motion.same_as(motion)
    assert motion.same_as(bodies.wandering(20, 1))
    assert loop.same_as(walker(0))
    bent = motion.rotations.copy()
    bent[7, 3] = [0.0, 1.0, 0.0, 0.0]
    longer = replace(motion.skeleton, offsets=motion.skeleton.offsets * 1.1)
    for other in (
        motion[:19],
        bodies.wandering(20, 2),
        replace(motion, rotations=bent),
        replace(motion, root=motion.root + np.arange(20)[:, None]),
        replace(motion, fps=60.0),
        replace(motion, skeleton=longer),
        replace(motion, skeleton=replace(motion.skeleton, roles={})),
    ):
        assert not motion.same_as(other)
        assert not other.same_as(motion)
    assert not loop.same_as(replace(loop, cycle=None))
    assert not loop.same_as(replace(loop, cycle=replace(loop.cycle, period=9.0)))
