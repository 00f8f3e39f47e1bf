"""Film strips: a few frames of a clip side by side in one picture, to look at."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import numpy as np

from stimuli.files import write_atomic
from stimuli.render.video import Pictures

FOOT = 26  # pixels under the pictures, for their numbers and the mark of the blend
_INK, _MARK = 30, (200, 90, 30)


def strip(
    frames: Sequence[Pictures] | Pictures,
    count: int = 8,
    middle: int | None = None,
    mixed: tuple[int, int] | None = None,
) -> Pictures:
    """(height + FOOT, width', 3) `count` frames side by side, cropped to what moves.

    Around frame `middle` they are a tenth of the clip apart at most; without it they are spread
    over the whole clip. Each has its number under it, and a bar where the blend mixes it, from
    the first to the last frame of `mixed`.
    """
    chosen = chosen_frames(len(frames), count, middle)
    return strip_of([frames[number] for number in chosen], chosen, mixed)


def strip_of(
    pictures: Sequence[Pictures], numbers: Sequence[int], mixed: tuple[int, int] | None = None
) -> Pictures:
    """A strip of these pictures, whose frames have these numbers."""
    shown = np.stack(pictures)
    left, right = _columns(shown)
    whole = np.concatenate(list(shown[:, :, left:right]), axis=1)
    return np.concatenate([whole, _foot(numbers, right - left, mixed, whole[0, 0])])


def chosen_frames(length: int, count: int = 8, middle: int | None = None) -> list[int]:
    """The frames of a clip that a strip shows."""
    if middle is None:
        chosen = np.rint(np.linspace(0, length - 1, count)).astype(int)
    else:
        step = max(1, length // (4 * count))
        chosen = middle + step * (np.arange(count) - count // 2)
    return [int(number) for number in np.clip(chosen, 0, length - 1)]


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


def _foot(
    chosen: Sequence[int], width: int, mixed: tuple[int, int] | None, colour: Pictures
) -> Pictures:
    """(FOOT, width × frames, 3) the numbers, and a bar over those that the blend mixes."""
    from PIL import Image, ImageDraw, ImageFont

    image = Image.new("RGB", (width * len(chosen), FOOT), tuple(int(level) for level in colour))
    pen, font = ImageDraw.Draw(image), ImageFont.load_default(18)
    for place, number in enumerate(chosen):
        left = place * width
        if mixed is not None and mixed[0] <= number <= mixed[1]:
            pen.rectangle((left, 0, left + width - 1, 4), fill=_MARK)
        at = (left + width / 2, 6 + (FOOT - 6) / 2)
        pen.text(at, str(number), fill=(_INK,) * 3, anchor="mm", font=font)
    return np.array(image)


def _columns(pictures: Pictures, border: int = 12) -> tuple[int, int]:
    """First and last column in which any picture differs from its own corner."""
    differs = np.any(pictures != pictures[:, :1, :1], axis=(0, 1, 3))
    moving = np.flatnonzero(differs)
    if not len(moving):
        return 0, pictures.shape[2]
    return max(int(moving[0]) - border, 0), min(int(moving[-1]) + border, pictures.shape[2])
