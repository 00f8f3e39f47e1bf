"""How a clip is cut out of a transition, so that nothing before the blend tells clips apart.

The anchor length k (a group's reference) puts its blend's middle at the clip's middle frame m:
frame i of the *from* motion stands at m − ⌊k/2⌋ (start-end), or the instant of the transition at m
(center-aligned). Every other length of the group starts from the same first frame with i at the
same time.
"""

from dataclasses import dataclass

import numpy as np

from stimuli.motion.library import Library
from stimuli.motion.loops import unroll
from stimuli.motion.skeleton import Motion
from stimuli.sets.plan import ResolvedPairing
from stimuli.sets.refusals import RefusedError
from stimuli.sets.spec import Pairing, SetSpec
from stimuli.sets.ways import way_of
from stimuli.transition import LONGEST, Transition, transition


@dataclass(frozen=True, eq=False)
class LaidOut:
    """A clip's motion, where the transition stands in it, and what it was made of."""

    motion: Motion
    at: int  # clip frame in which frame i of the from motion (start-end), or the instant, stands
    transition: Transition
    mixed: tuple[int, int]  # first and last clip frame that the blend mixes
    altered: int  # first clip frame that is not the from motion's own: held feet are eased in


def frame_of_i(spec: SetSpec, anchor: int) -> int:
    """The clip frame in which frame i stands (center-aligned: the instant), at least 0."""
    if spec.specification == "center-aligned":
        return spec.middle
    return max(spec.middle - anchor // 2, 0)


def clip_motion(
    spec: SetSpec,
    resolved: ResolvedPairing,
    library: Library,
    *,
    method: str | None = None,
    length: int | None = None,
) -> Motion:
    """The motion of one clip, exactly `spec.frames` frames; see `lay_out`."""
    return lay_out(spec, resolved, library, method=method, length=length).motion


def lay_out(
    spec: SetSpec,
    resolved: ResolvedPairing,
    library: Library,
    *,
    method: str | None = None,
    length: int | None = None,
) -> LaidOut:
    """One clip of a pairing, of a method or of a length.

    Loops are unrolled as needed; RefusedError where motions have too few frames for the clip.
    """
    pairing = resolved.pairing
    at = frame_of_i(spec, resolved.anchor)
    assert (method is None) != (length is None), "a clip is of a method or of a length"
    a, i = _from_motion(pairing, library, at)
    b, j = _to_motion(spec, pairing, library, at)
    joined = transition(
        a, b, i, j,
        method=method or "geodesic", specification=spec.specification,
        frames=length, smooth=spec.smooth, foot_lock=spec.foot_lock,
        route=way_of(spec, pairing, library, method) if method else None,
    )  # fmt: skip
    start = i - at
    after = start + spec.frames - len(joined.motion)
    if start < 0 or after > 0:
        raise RefusedError(
            [
                *(
                    [_too_few(pairing.from_clip, pairing.from_frame, "before", -start)]
                    * (start < 0)
                ),
                *([_too_few(pairing.to_clip, pairing.to_frame, "after", after)] * (after > 0)),
            ]
        )
    cut = joined.motion[start : start + spec.frames]
    first, last = joined.mixed
    same = np.all(joined.motion.rotations[:i] == a.rotations[:i], axis=(1, 2))
    altered = first if same.all() else min(first, int(np.argmin(same)))
    return LaidOut(cut, at, joined, (first - start, last - start), altered - start)


def _from_motion(pairing: Pairing, library: Library, at: int) -> tuple[Motion, int]:
    """The from motion with `at` frames before frame i if it is a loop, and where i is in it."""
    motion = library.load(pairing.from_clip).motion
    before = max(at, LONGEST) - pairing.from_frame
    after = LONGEST - (len(motion) - 1 - pairing.from_frame)
    motion, shift = unroll(motion, before, after)
    return motion, pairing.from_frame + shift


def _to_motion(spec: SetSpec, pairing: Pairing, library: Library, at: int) -> tuple[Motion, int]:
    """The to motion with enough frames around j, and where j is in it."""
    motion = library.load(pairing.to_clip).motion
    rest = spec.frames - at  # frames of the clip from frame i, or the instant, on
    after = max(rest, LONGEST) - (len(motion) - 1 - pairing.to_frame)
    motion, shift = unroll(motion, LONGEST - pairing.to_frame, after)
    return motion, pairing.to_frame + shift


def _too_few(clip: str, frame: int, where: str, missing: int) -> str:
    return (
        f"{clip}: expected enough frames {where} frame {frame} to fill the clip, found "
        f"{missing} too few.\nChoose another frame, or shorter clips (seconds)."
    )
