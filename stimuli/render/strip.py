"""Film strips: a few frames of a clip side by side in one picture, to look at."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import numpy as np

from stimuli.files import write_atomic
from stimuli.render.video import Pictures


def strip(
    frames: Sequence[Pictures] | Pictures, count: int = 8, middle: int | None = None
) -> Pictures:
    """(height, width', 3) `count` frames side by side, cropped to what moves.

    Around frame `middle` they are a tenth of the clip apart at most; without it they are spread
    over the whole clip.
    """
    every = np.asarray(frames)
    if middle is None:
        chosen = np.rint(np.linspace(0, len(every) - 1, count)).astype(int)
    else:
        step = max(1, len(every) // (4 * count))
        chosen = middle + step * (np.arange(count) - count // 2)
    shown = every[np.clip(chosen, 0, len(every) - 1)]
    left, right = _columns(shown)
    return np.concatenate(list(shown[:, :, left:right]), axis=1)


def write_png(path: Path, picture: Pictures) -> None:
    """Write a picture (height, width, 3) as PNG, whole or not at all."""
    import av

    codec = av.CodecContext.create("png", "w")
    codec.height, codec.width = picture.shape[:2]
    codec.pix_fmt = "rgb24"
    codec.time_base = Fraction(1)
    frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="rgb24")
    packets = [*codec.encode(frame), *codec.encode(None)]
    write_atomic(path, b"".join(bytes(packet) for packet in packets))


def _columns(pictures: Pictures, border: int = 12) -> tuple[int, int]:
    """First and last column in which any picture differs from its own corner."""
    differs = np.any(pictures != pictures[:, :1, :1], axis=(0, 1, 3))
    moving = np.flatnonzero(differs)
    if not len(moving):
        return 0, pictures.shape[2]
    return max(int(moving[0]) - border, 0), min(int(moving[-1]) + border, pictures.shape[2])
