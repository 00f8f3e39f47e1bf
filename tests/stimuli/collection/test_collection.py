"""Clips taken together: what makes a collection, what is refused, what is done in which frames."""

import re
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest

from stimuli.collection import annotated, collected, gathered
from stimuli.collection.annotations import Span, words_of
from stimuli.errors import InputError
from stimuli.motion import Library, Skeleton, load_clip, write_walker


@pytest.fixture(scope="module")
def clips(tmp_path_factory: pytest.TempPathFactory):
    folder = tmp_path_factory.mktemp("walkers")
    return [load_clip(write_walker(folder, seed)) for seed in range(3)]


def renamed(clip):
    """The clip on a skeleton of other names."""
    body = clip.motion.skeleton
    other = Skeleton(tuple(f"x{name}" for name in body.names), body.parents, body.offsets,
                     body.end_parents, body.end_offsets, body.roles)  # fmt: skip
    return replace(clip, name="other", motion=replace(clip.motion, skeleton=other))


def test_clips_of_one_hierarchy_are_on_one_body_and_loops_are_played_on(clips) -> None:
    collection = gathered(clips)
    assert len(collection) == 3
    assert all(motion.skeleton is collection.skeleton for motion in collection.motions)
    for clip, motion in zip(clips, collection.motions, strict=True):
        assert not motion.loop
        if clip.motion.loop:
            assert len(motion) >= 2.9 * clip.motion.cycle.period
    assert collection.starts[-1] == sum(map(len, collection.motions))
    assert gathered(clips).hash == collection.hash
    assert gathered(clips[:2]).hash != collection.hash


def test_all_that_is_wrong_with_a_collection_is_told_at_once(clips) -> None:
    body = clips[0].motion.skeleton
    bare = replace(body, roles=MappingProxyType({}))
    roleless = replace(clips[0], motion=replace(clips[0].motion, skeleton=bare))
    short = replace(clips[1], name="short", motion=clips[1].motion[:2])
    with pytest.raises(InputError) as refused:
        gathered([roleless, renamed(clips[1]), short])
    told = str(refused.value).splitlines()
    assert len(told) == 3
    assert "one hierarchy" in told[0]
    assert "others: other" in told[0]
    assert "left_hip, right_hip" in told[1]
    assert "overrides.toml" in told[1]
    assert "4 frames or more" in told[2]
    with pytest.raises(InputError, match="found none"):
        gathered([])


def test_one_clip_is_a_collection_with_a_remark(clips) -> None:
    (remark,) = gathered(clips[:1]).remarks
    assert "it can only be cut to itself" in remark


def test_clips_of_one_name_are_told_apart_by_their_folders(clips) -> None:
    twins = [
        replace(clips[0], name="walk", path=Path(f"/motions/{folder}/walk.bvh"))
        for folder in ("one", "two")
    ]
    assert gathered(twins).names == ("one/walk", "two/walk")
    with pytest.raises(InputError, match="expected a clip of the collection"):
        gathered(twins).place("walk")


def test_patterns_choose_clips_of_a_library(tmp_path: Path) -> None:
    for seed in range(3):
        write_walker(tmp_path, seed)
    library = Library([tmp_path])
    stems = [path.stem for path in library.paths()]
    assert collected(library, (stems[0], stems[2])).names == (stems[0], stems[2])
    with pytest.raises(InputError, match=re.escape("zz*: expected clips of such names")):
        collected(library, ("*", "zz*"))


def test_words_of_a_name_are_what_is_done_in_a_clip() -> None:
    assert words_of("Male1_B9_WalkToTurnLeft90") == ("male", "walk", "turn", "left")
    assert words_of("humanoid3d_spinkick") == ("humanoid", "spinkick")


def test_a_table_beside_a_clip_says_what_is_done_in_which_frames(clips, tmp_path: Path) -> None:
    clip = replace(clips[0], name="walk", path=tmp_path / "walk.bvh")
    assert annotated(clip, 50) == (Span(0, 49, "walk"),)
    table = tmp_path / "annotations.csv"
    table.write_text("clip,from_frame,to_frame,label\nwalk,3,20,Stroll\nrun,0,5,run\n")
    assert annotated(clip, 50) == (Span(3, 20, "stroll"),)


def test_faults_of_a_table_are_told_at_once_each_with_its_line(clips, tmp_path: Path) -> None:
    table = tmp_path / "annotations.csv"
    table.write_text("clip,from_frame,to_frame,label\nwalk,x,20,a\nwalk,9,3,a\n,1,2,\n")
    clip = replace(clips[0], name="walk", path=tmp_path / "walk.bvh")
    with pytest.raises(InputError) as refused:
        annotated(clip, 50)
    told = str(refused.value).splitlines()
    assert [re.search(r":(\d):", line)[1] for line in told] == ["2", "3", "4"]
    table = tmp_path / "second"
    table.mkdir()
    (table / "annotations.csv").write_text("name,label\n")
    with pytest.raises(InputError, match="1: expected the columns"):
        annotated(replace(clip, path=table / "walk.bvh"), 50)


def test_the_hash_is_of_the_frames(clips) -> None:
    still = replace(clips[0].motion, cycle=None)
    moved = replace(still, root=still.root + np.array([0.0, 1e-9, 0.0]))
    one, other = (gathered([replace(clips[0], motion=motion)]).hash for motion in (still, moved))
    assert one != other
