"""Which frames a build draws: each once, however many clips of a group show it.

Before and after blends of different lengths the clips of a group show the same pictures. A frame
is known by what its picture depends on, and is drawn with the first clip that has it.
"""

import hashlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stimuli.render.appearance import Appearance
from stimuli.render.camera import Camera
from stimuli.render.ground import GroundMotion
from stimuli.render.skin import Skin

FrameKey = bytes  # of a frame's picture, within a group


@dataclass(frozen=True, eq=False)
class Scenery:
    """What all clips of a group share: the body's skin, the camera, the look."""

    name: str
    skin: Skin
    camera: Camera
    look: Appearance

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the pictures, in pixels."""
        return self.look.width, self.look.height


@dataclass(frozen=True, eq=False)
class DrawJob:
    """A clip's motion, and which of its frames no clip before it has: those that are drawn."""

    scenery: str
    keys: tuple[FrameKey, ...]  # of the frames that are drawn
    places: tuple[int, ...]  # of them in the clip
    bones: NDArray[np.float32]  # (F, B, 8) of the whole clip
    ground: GroundMotion | None = None


@dataclass(frozen=True)
class DrawnFrame:
    """A frame packed for a master, and the SHA-256 of its RGB bytes."""

    key: FrameKey
    packed: bytes
    sha256: bytes


def frame_keys(
    scenery: Scenery, bones: NDArray[np.float32], ground: GroundMotion | None = None
) -> list[FrameKey]:
    """What tells the pictures of a scenery apart, for each frame of bones (F, B, 8)."""
    start = hashlib.blake2b(scenery.name.encode(), digest_size=16)
    single = one_sign(bones)

    def key(frame: int) -> FrameKey:
        known = start.copy()
        known.update(single[frame].tobytes())
        known.update(repr(scenery.camera.at(frame)).encode())
        if ground is not None:
            known.update(ground.casters[frame].tobytes())
            known.update(ground.middles[frame].tobytes())
        return known.digest()

    return [key(frame) for frame in range(len(bones))]


def one_sign(bones: NDArray[np.float32]) -> NDArray[np.float32]:
    """Bones (F, B, 8) whose first real part is positive: a motion and its negative are one.

    What is drawn of either is the same, since every product of two parts is.
    """
    sign = np.where(bones[:, :1, :1] < 0, np.float32(-1), np.float32(1))
    return bones * sign + np.float32(0)  # which makes every zero positive


def jobs_of(
    scenery: Scenery, clips: Iterable[tuple[str, NDArray[np.float32], GroundMotion | None]]
) -> Iterator[tuple[str, list[FrameKey], DrawJob]]:
    """For each clip (name, bones, ground) its frames, and which of them are drawn for it."""
    known: set[FrameKey] = set()
    for name, bones, ground in clips:
        keys = frame_keys(scenery, bones, ground)
        first = {key: place for place, key in reversed(list(enumerate(keys))) if key not in known}
        fresh = sorted(first.values())
        known.update(first)
        drawn = tuple(keys[place] for place in fresh)
        yield name, keys, DrawJob(scenery.name, drawn, tuple(fresh), one_sign(bones), ground)
