"""The pictures of a motion's clips, each kept once, and what is known of the clips."""

import hashlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np

from stimuli.processes import mapped
from stimuli.render.video import Pictures
from stimuli.sets.manifest import ClipEntry, Manifest
from stimuli.sets.masters import clip_frames

WIDEST = 640  # pixels of a picture in the page; a master may have more
QUALITY = 88  # of WebP, a seventh of JPEG in size; the background stays exact
_COLUMNS = 9  # pictures of a strip
_TALLEST = 400  # lines of a picture that a strip is cut from; a master may have more


@dataclass(frozen=True)
class Strip:
    """A few frames of a clip, cut to where the figures of the motion's strips are."""

    numbers: tuple[int, ...]
    pictures: Pictures  # (n, height, width, 3)


@dataclass(frozen=True)
class MotionSheet:
    """A motion's clips: `images` are WebP files, `frames` name for each clip one a frame."""

    motion: str
    clips: tuple[ClipEntry, ...]
    frames: tuple[tuple[int, ...], ...]
    images: tuple[bytes, ...]
    strips: tuple[Strip, ...]
    size: tuple[int, int]  # of the images, width and height


def gather(
    manifest: Manifest, workers: int | None = None, progress: Callable[[int], None] | None = None
) -> Iterator[MotionSheet]:
    """Each motion of a set, in the manifest's order, read in processes of their own.

    InputError where a clip's file is not what the set was built with.
    """
    jobs = [
        tuple(entry for entry in manifest.clips if entry.motion == motion)
        for motion in dict.fromkeys(entry.motion for entry in manifest.clips)
    ]
    for done, shown in enumerate(mapped(_shown, jobs, workers, len(jobs)), 1):
        yield shown
        if progress:
            progress(done)


def label(entry: ClipEntry, pairing: Mapping[str, Any]) -> str:
    """What a clip is called beside the others of its motion."""
    frames = f"{entry.length} frame{'' if entry.length == 1 else 's'}"
    if entry.method is not None:
        return f"{entry.method}, {frames}"
    reference = pairing.get("reference_length")
    if reference is None or entry.length == reference:
        return f"{frames}, the reference" if reference else frames
    return f"{frames} ({entry.length - reference:+d})"


def blend(entry: ClipEntry) -> tuple[int, int]:
    """First and last frame that the blend mixes, within the clip."""
    first, last = entry.document["mixed"]
    return max(int(first), 0), min(int(last), entry.frames - 1)


def _shown(clips: tuple[ClipEntry, ...]) -> MotionSheet:
    known: dict[bytes, int] = {}
    images: list[bytes] = []
    frames, cut = [], []
    numbers = _numbers(clips)
    small: tuple[int, int] = (0, 0)
    for entry in clips:
        places, chosen = [], []
        for number, picture in enumerate(clip_frames(entry)):
            small = _fitting(picture.shape[1], picture.shape[0])
            key = hashlib.blake2b(picture.data, digest_size=16).digest()
            if key not in known:
                known[key] = len(images)
                images.append(_webp(picture, small))
            places.append(known[key])
            if number in numbers:
                chosen.append(_lower(picture))
        frames.append(tuple(places))
        cut.append(np.stack(chosen))
    boxed = _box(np.concatenate(cut))
    strips = tuple(
        Strip(numbers, np.ascontiguousarray(each[:, boxed[0], boxed[1]])) for each in cut
    )
    return MotionSheet(clips[0].motion, clips, tuple(frames), tuple(images), strips, small)


def _numbers(clips: tuple[ClipEntry, ...]) -> tuple[int, ...]:
    """Frames of the strips, alike for all clips of a motion: around the longest blend."""
    first, last = (bound(blend(each)[k] for each in clips) for k, bound in ((0, min), (1, max)))
    around = max(6, (last - first) // 2)
    low, high = max(first - around, 0), min(last + around, clips[0].frames - 1)
    return tuple(dict.fromkeys(int(n) for n in np.rint(np.linspace(low, high, _COLUMNS))))


def _fitting(width: int, height: int) -> tuple[int, int]:
    scale = min(1.0, WIDEST / width)
    return round(width * scale), round(height * scale)


def _lower(picture: Pictures) -> Pictures:
    """The picture with at most `_TALLEST` lines; where it is of one colour it stays so."""
    from PIL import Image

    high, wide = picture.shape[:2]
    if high <= _TALLEST:
        return picture
    size = round(wide * _TALLEST / high), _TALLEST
    return np.asarray(Image.fromarray(picture).resize(size, Image.Resampling.BOX))


def _webp(picture: Pictures, size: tuple[int, int]) -> bytes:
    from PIL import Image

    image = Image.fromarray(picture)
    if image.size != size:
        image = image.resize(size, Image.Resampling.BOX)
    stream = BytesIO()
    image.save(stream, "WEBP", quality=QUALITY, method=2)
    return stream.getvalue()


def _box(pictures: Pictures, border: int = 8) -> tuple[slice, slice]:
    """Rows and columns that hold what differs from the background in any picture."""
    differs = np.any(pictures != pictures[:, :1, :1], axis=-1)
    found = []
    for axis, size in ((2, pictures.shape[1]), (1, pictures.shape[2])):
        there = np.flatnonzero(differs.any(axis=(0, axis)))
        low, high = (there[0], there[-1] + 1) if len(there) else (0, size)
        found.append(slice(max(int(low) - border, 0), min(int(high) + border, size)))
    return found[0], found[1]
