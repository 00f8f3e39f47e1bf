"""One PNG of a whole set: strips in step, with frame numbers and the blend marked."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from stimuli.render.strip import write_png
from stimuli.sets.manifest import Manifest
from stimuli.sheet.gathered import MotionSheet, blend, label

HIGH = 180  # pixels of a strip at most
MARGIN, GAP, NAME, _LINE = 16, 2, 190, 18
_INK, _FAINT, _PAPER, _MIXED = (30, 32, 36), (110, 114, 120), (250, 250, 248), (196, 78, 32)


def write_strips(manifest: Manifest, shown: Sequence[MotionSheet], path: Path) -> None:
    """Write the picture, whole or not at all."""
    blocks = [_block(manifest, each) for each in shown]
    width = max(block.shape[1] for block in blocks) + 2 * MARGIN
    head = _text(f"{manifest.name}: {len(manifest.clips)} clips, {manifest.specification}, "
                 f"{manifest.seconds:g} s at {manifest.fps} frames a second; framed in orange: "
                 "frames that the blend mixes", width - 2 * MARGIN, 20, _INK)  # fmt: skip
    rows = [head, *blocks]
    height = sum(row.shape[0] + MARGIN for row in rows) + MARGIN
    sheet = np.full((height, width, 3), _PAPER, dtype=np.uint8)
    top = MARGIN
    for row in rows:
        sheet[top : top + row.shape[0], MARGIN : MARGIN + row.shape[1]] = row
        top += row.shape[0] + MARGIN
    write_png(path, sheet)


def _block(manifest: Manifest, shown: MotionSheet) -> Any:
    """A motion's name, frame numbers, and a row for each clip."""
    from PIL import Image, ImageDraw

    pairing = manifest.pairings[shown.motion]
    cells = shown.strips[0].pictures
    scale = min(1.0, HIGH / cells.shape[1])
    wide, high = round(cells.shape[2] * scale), round(cells.shape[1] * scale)
    columns = len(shown.strips[0].numbers)
    width = NAME + columns * (wide + GAP)
    top = 2 * _LINE + 8
    image = Image.new("RGB", (width, top + len(shown.clips) * (high + GAP)), _PAPER)
    draw = ImageDraw.Draw(image)
    ends = [f"{pairing[side]['clip']}:{pairing[side]['frame']}" for side in ("from", "to")]
    draw.text((0, 0), f"{shown.motion}   {' to '.join(ends)}", _INK, _font(15))
    for place, number in enumerate(shown.strips[0].numbers):
        left = NAME + place * (wide + GAP)
        draw.text((left + wide / 2, _LINE + 14), str(number), _FAINT, _font(12), anchor="mm")
    for row, (entry, strip) in enumerate(zip(shown.clips, shown.strips, strict=True)):
        y = top + row * (high + GAP)
        draw.text((0, y + high / 2), label(entry, pairing), _INK, _font(13), anchor="lm")
        first, last = blend(entry)
        for place, (number, picture) in enumerate(zip(strip.numbers, strip.pictures, strict=True)):
            left = NAME + place * (wide + GAP)
            cell = Image.fromarray(picture).resize((wide, high), Image.Resampling.LANCZOS)
            image.paste(cell, (left, y))
            if first <= number <= last:
                draw.rectangle((left, y, left + wide - 1, y + high - 1), outline=_MIXED, width=2)
    return np.asarray(image)


def _text(words: str, width: int, high: int, ink: tuple[int, int, int]) -> Any:
    from PIL import Image, ImageDraw

    image = Image.new("RGB", (width, high), _PAPER)
    ImageDraw.Draw(image).text((0, high / 2), words, ink, _font(14), anchor="lm")
    return np.asarray(image)


def _font(size: int) -> Any:
    from PIL import ImageFont

    return ImageFont.load_default(size)
