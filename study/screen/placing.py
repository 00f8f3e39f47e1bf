"""Where on a screen the clips of a trial are shown, how large, and under what visual angle."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

USUAL_WIDTH = 53.0  # cm, of a screen of which nobody says how wide it is
ROW_GAP = 0.01  # of the window's width, left free beside each of several clips
PAIR_GAP = 0.08  # and between two pairs


@dataclass(frozen=True)
class Placing:
    """Clips side by side: their size in pixels, and their middles from the window's, y up.

    `scale` is screen pixels for each of the picture's.
    """

    size: tuple[int, int]
    centres: tuple[tuple[float, float], ...]
    scale: float


def side_by_side(
    window: tuple[int, int],
    picture: tuple[int, int],
    count: int,
    share: float,
    enlarge: bool = False,
) -> Placing:
    """`count` clips beside each other in a window, both (width, height) in pixels.

    They fill `share` of its height, or of its width (several clips share all of that), as the
    layout allows; larger than pixel for pixel only to `enlarge`. Edges lie between pixels. Four
    clips are two pairs, further apart from each other.
    """
    between = round(PAIR_GAP * window[0]) if count == 4 else 0
    across = share if count == 1 else (1 - ROW_GAP * (count + 1) - between / window[0]) / count
    fitting = min(share * window[1] / picture[1], across * window[0] / picture[0])
    scale = fitting if enlarge else min(fitting, 1.0)
    wide, tall = (max(round(scale * side), 1) for side in picture)
    step = wide + round(ROW_GAP * window[0])
    row = count * wide + (count - 1) * (step - wide) + between
    left, bottom = (window[0] - row) // 2, (window[1] - tall) // 2
    centres = tuple(
        (
            left + n * step + between * (n >= count / 2) + wide / 2 - window[0] / 2,
            bottom + tall / 2 - window[1] / 2,
        )
        for n in range(count)
    )
    return Placing((wide, tall), centres, scale)


def visual_angle(pixels: float, pixel: float, distance: float) -> float:
    """Degrees that so many pixels in the middle of a screen are seen under.

    `pixel` is the side of one and `distance` that of the eye, both in cm.
    """
    return float(np.degrees(2 * np.arctan(pixels * pixel / 2 / distance)))


def shown_sizes(
    placing: Placing, screen: Any, given: float | None, distance: float
) -> Mapping[str, object]:
    """What a record says of the pictures on a pyglet screen, seen from `distance` cm.

    The screen is `given` cm wide, or as wide as the system says; where nobody says, there are no
    degrees. The scale is screen pixels for each of the picture's.
    """
    wide = system_width(screen) if given is None else given
    pixel = None if wide is None else wide / screen.width
    angle = None
    if pixel is not None:
        angle = [round(visual_angle(side, pixel, distance), 3) for side in placing.size]
    said = "protocol" if given is not None else "system"
    return {
        "size": list(placing.size),
        "scale": round(placing.scale, 4),
        "degrees": angle,
        "viewing_distance_cm": distance,
        "screen_width_cm": None if wide is None else round(wide, 2),
        "screen_width_from": None if wide is None else said,
    }


def pixel_side(screen: Any, given: float | None) -> float:
    """The side of a pixel (cm) of a pyglet screen `given` cm wide, or as the system says, else of
    one that is as wide as most."""
    wide = system_width(screen) if given is None else given
    return float((wide or USUAL_WIDTH) / screen.width)


def system_width(screen: Any) -> float | None:
    """The width of a pyglet screen (cm) as the X server has it; None where it does not say."""
    display: Any = getattr(screen, "display", None)
    x_display = getattr(display, "_display", None)
    if x_display is None:
        return None
    from pyglet.libs.x11 import xlib

    wide = xlib.XDisplayWidthMM(x_display, display.x_screen)
    pixels = xlib.XDisplayWidth(x_display, display.x_screen)
    return float(wide / 10 * screen.width / pixels) if wide > 0 else None
