"""Where the blend stands in a clip: the interface's sentence on odd-pair groups, as arithmetic."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stimuli.errors import InputError
from stimuli.motion import Library, Motion
from stimuli.sets import Pairing, SetSpec, clip_motion, resolve
from stimuli.sets.layout import frame_of_i, lay_out
from stimuli.transition.footlock import EASE
from tests.corpora import CORPORA

lengths = st.integers(1, 40)
specifications = st.sampled_from(["start-end", "center-aligned"])


class Straight:
    """A library of long motions that are no loops."""

    def __init__(self, library: Library, frames: int = 400) -> None:
        from stimuli.motion import unroll

        self.clips = {}
        for clip in (library.load(path.stem) for path in library.paths()):
            long, _ = unroll(clip.motion, 0, frames)
            still = Motion(long.skeleton, long.rotations[:frames], long.root[:frames])
            self.clips[clip.name] = SimpleNamespace(motion=still)

    def load(self, name: str) -> Any:
        return self.clips[name]


@pytest.fixture(scope="session")
def straight(library: Library) -> Straight:
    return Straight(library)


def one(specification: str, reference: int, others: set[int], seconds: float = 6.0) -> SetSpec:
    return SetSpec(
        "one", (Pairing("w", "generated-walker-0", 150, "generated-walker-1", 140),),
        specification, reference=reference,
        shorter=tuple(reference - n for n in others if n < reference),
        longer=tuple(n - reference for n in others if n > reference), seconds=seconds,
        foot_lock=False,
    )  # fmt: skip


@settings(max_examples=25)
@given(specification=specifications, k=lengths, other=lengths)
def test_clips_of_a_group_are_the_same_up_to_the_first_blend(
    straight: Straight, specification: str, k: int, other: int
) -> None:
    spec = one(specification, k, {other})
    resolved = resolve(spec, straight)[0]  # type: ignore[arg-type]
    reference, second = (
        lay_out(spec, resolved, straight, length=length)  # type: ignore[arg-type]
        for length in (k, other)
    )
    assert len(reference.motion) == len(second.motion) == 180
    before = min(reference.mixed[0], second.mixed[0])
    assert min(reference.altered, second.altered) == before
    np.testing.assert_array_equal(
        reference.motion.rotations[:before], second.motion.rotations[:before]
    )
    np.testing.assert_array_equal(reference.motion.root[:before], second.motion.root[:before])
    a = straight.load("generated-walker-0").motion
    np.testing.assert_allclose(reference.motion.root[0], a.root[150 - reference.at])


@settings(max_examples=25)
@given(specification=specifications, k=lengths, other=lengths)
def test_the_reference_blend_has_its_middle_at_frame_90(
    straight: Straight, specification: str, k: int, other: int
) -> None:
    spec = one(specification, k, {other})
    resolved = resolve(spec, straight)[0]  # type: ignore[arg-type]
    reference, second = (
        lay_out(spec, resolved, straight, length=length)  # type: ignore[arg-type]
        for length in (k, other)
    )
    if specification == "start-end":
        assert reference.at == second.at == 90 - k // 2
        assert reference.mixed == (90 - k // 2, 90 - k // 2 + k - 1)
        assert second.mixed == (90 - k // 2, 90 - k // 2 + other - 1)
    else:
        assert reference.at == second.at == 90
        assert reference.mixed == (90 - k // 2, 90 + k // 2)
        assert second.mixed == (90 - other // 2, 90 + other // 2)
    assert abs(sum(reference.mixed) / 2 - 90) <= 0.5


def test_held_feet_alter_no_more_than_their_easing_before_the_blend(straight: Straight) -> None:
    spec = replace(one("center-aligned", 10, {4}), foot_lock=True)
    resolved = resolve(spec, straight)[0]  # type: ignore[arg-type]
    clips = [lay_out(spec, resolved, straight, length=n) for n in (4, 10)]  # type: ignore[arg-type]
    for clip in clips:
        assert clip.mixed[0] - EASE <= clip.altered <= clip.mixed[0]
    same = min(clip.altered for clip in clips)
    np.testing.assert_array_equal(
        clips[0].motion.rotations[:same], clips[1].motion.rotations[:same]
    )


def test_after_the_blend_comes_the_to_motion_in_step(straight: Straight) -> None:
    spec = one("start-end", 10, {14})
    resolved = resolve(spec, straight)[0]  # type: ignore[arg-type]
    b = straight.load("generated-walker-1").motion
    for length in (10, 14):
        clip = lay_out(spec, resolved, straight, length=length)  # type: ignore[arg-type]
        last = clip.mixed[1]
        np.testing.assert_allclose(
            np.abs(np.einsum("fji,fji->fj", clip.motion.rotations[last + 1 :, 1:],
                             b.rotations[141 : 141 + 180 - last - 1, 1:])), 1.0, atol=1e-9,
        )  # fmt: skip


def test_a_short_clip_keeps_its_blend_in_the_middle() -> None:
    spec = one("start-end", 10, set(), seconds=1.0)
    assert spec.frames == 30
    assert frame_of_i(spec, 10) == 10
    assert frame_of_i(replace(spec, specification="center-aligned"), 10) == 15
    assert frame_of_i(spec, 40) == 0


def test_loops_are_unrolled_to_fill_the_clip(library: Library, spec: SetSpec) -> None:
    long = replace(spec, seconds=6.0)
    resolved = resolve(long, library)[0]
    motion = clip_motion(long, resolved, library, length=6)
    assert len(motion) == 180
    steps = np.linalg.norm(np.diff(motion.root[:, [0, 2]], axis=0), axis=1)
    assert steps.max() < 3 * np.median(steps)


@pytest.mark.parametrize(
    ("frame", "to_frame", "what"),
    [
        (5, 200, r"generated-walker-0.*before frame 5 .*found 80"),
        (150, 399, r"generated-walker-1.*after"),
    ],
)
def test_too_few_frames_are_named(straight: Straight, frame: int, to_frame: int, what: str) -> None:
    pairing = Pairing("w", "generated-walker-0", frame, "generated-walker-1", to_frame)
    spec = replace(one("start-end", 10, set()), pairings=(pairing,))
    with pytest.raises(InputError, match=f"(?s){what}"):
        clip_motion(spec, resolve(spec, straight)[0], straight, length=10)  # type: ignore[arg-type]


def test_methods_go_by_the_first_named_length(straight: Straight) -> None:
    spec = replace(one("start-end", 1, set()), reference=None, methods=("geodesic", "fixed"))
    resolved = resolve(spec, straight)[0]  # type: ignore[arg-type]
    k = resolved.methods["geodesic"]
    assert resolved.anchor == k
    assert resolved.methods["fixed"] == 10
    for method in spec.methods:
        clip = lay_out(spec, resolved, straight, method=method)  # type: ignore[arg-type]
        assert clip.at == 90 - k // 2
        assert clip.transition.frames == resolved.methods[method]


def test_a_cut_shows_no_blend(straight: Straight) -> None:
    spec = replace(one("start-end", 1, set()), reference=None, methods=("cut",))
    resolved = resolve(spec, straight)[0]  # type: ignore[arg-type]
    clip = lay_out(spec, resolved, straight, method="cut")  # type: ignore[arg-type]
    assert clip.at == clip.mixed[0] == clip.mixed[1] == 90


@pytest.mark.parametrize("corpus", CORPORA)
def test_captured_clips_fill_six_seconds(corpus: str, sample_motions: Path) -> None:
    library = Library(CORPORA[corpus].folders)
    clips = {"sample": ("humanoid3d_getup_faceup", 95, "humanoid3d_dance_b", 30),
             "captured": ("05_02", 246, "05_13", 90)}[corpus]  # fmt: skip
    spec = SetSpec("six", (Pairing("dance", *clips),), "center-aligned", reference=10, longer=(12,))
    resolved = resolve(spec, library)[0]
    motion = clip_motion(spec, resolved, library, length=22)
    assert len(motion) == 180
    source = library.load(clips[0]).motion
    np.testing.assert_allclose(motion.root[0], source.root[clips[1] - 90])
