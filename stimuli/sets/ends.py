"""How far a clip lies from its group's reference: outside the blend, where nothing should tell,
and in the picture, as the eye would see it."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from stimuli.motion.kinematics import forward
from stimuli.motion.skeleton import Motion
from stimuli.render.camera import Camera
from stimuli.sets.layout import LaidOut

Places = NDArray[np.floating]


def end_displacements(clip: LaidOut, reference: LaidOut) -> dict[str, float | None]:
    """Mean distance (metres) of a joint from where it is in the reference clip at the same frame.

    `displacement_before` is over the frames before either blend, `displacement_after` over those
    after both; None where there are no such frames.
    """
    apart = np.linalg.norm(_places(clip.motion) - _places(reference.motion), axis=-1)
    before, _, after = _parted(apart.mean(axis=1), clip, reference)
    return {"displacement_before": before, "displacement_after": after}


def picture_displacements(
    clip: LaidOut, reference: LaidOut, camera: Camera, degrees: float
) -> dict[str, float | None]:
    """The same in the picture: degrees of visual angle by which a joint is seen elsewhere.

    Before either blend, over the frames that either mixes, and after both, for an eye that sees
    the picture's height under `degrees`; None where there are no such frames.
    """
    one, other = (_sight_lines(camera, _places(each.motion), degrees) for each in (clip, reference))
    apart = _angles(one, other)
    before, within, after = _parted(apart.mean(axis=1), clip, reference)
    return {"picture_before": before, "picture_in": within, "picture_after": after}


@lru_cache(maxsize=64)
def _places(motion: Motion) -> Places:
    """(F, J, 3) where the joints are, in metres."""
    return forward(motion.skeleton, motion.rotations, motion.root)[0]


def _parted(
    values: Places, clip: LaidOut, reference: LaidOut
) -> tuple[float | None, float | None, float | None]:
    """Means of values (F,) before either blend, in the frames that either mixes, and after both."""
    first = max(min(clip.mixed[0], reference.mixed[0]), 0)
    last = max(clip.mixed[1], reference.mixed[1])
    before, within, after = (
        float(part.mean()) if len(part) else None
        for part in (values[:first], values[first : last + 1], values[last + 1 :])
    )
    return before, within, after


def _sight_lines(camera: Camera, places: Places, degrees: float) -> Places:
    """(F, J, 3) unit directions to the picture's places of points (F, J, 3), for that eye."""
    pixels, _ = camera.project(places, 2, 2)  # the picture's half-height is one
    aside = (pixels - 1) * np.tan(np.radians(degrees / 2))
    lines = np.concatenate([aside, np.ones_like(aside[..., :1])], axis=-1)
    return lines / np.linalg.norm(lines, axis=-1, keepdims=True)


def _angles(one: Places, other: Places) -> Places:
    """Degrees between unit directions, exact for small angles too."""
    return np.degrees(2 * np.arcsin(np.clip(np.linalg.norm(one - other, axis=-1) / 2, 0, 1)))
