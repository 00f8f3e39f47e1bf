"""Soft studio light, computed at the vertices.

A large key light over the camera's shoulder, a weaker fill from the other side and a sky brighter
than the floor; lights turn with the camera, so every group is lit alike. The sum stays below
white: no highlight is clipped. Light at the vertices costs a fraction of light at every sample
of the software rasteriser, and shows no facets on a fine mesh.
"""

import numpy as np

from stimuli.render.shapes import Floats

KEY = (-0.55, 0.65, 0.80)  # towards the light, in the camera's right, up and backward directions
FILL = (0.85, 0.15, 0.45)
KEY_POWER, FILL_POWER = 0.90, 0.14
SKY, FLOOR = 0.24, 0.07
_WRAP = 0.25  # how far the key light reaches around the edge: a large source, not a point
GAMMA = 1 / 2.2


def shade(normals: Floats, openness: Floats, axes: Floats) -> Floats:
    """(V,) brightness 0..1 as shown on a screen, for a camera with `axes` (3, 3)."""
    key, fill = (axes @ (np.array(light) / np.linalg.norm(light)) for light in (KEY, FILL))
    lit = normals @ np.stack([key, fill, [0.0, 1.0, 0.0]], axis=-1).astype(np.float32)
    wrapped = np.maximum((lit[:, 0] + _WRAP) / (1 + _WRAP), 0.0)
    direct = KEY_POWER * wrapped * wrapped + FILL_POWER * np.maximum(lit[:, 1], 0.0)
    sky = FLOOR + (SKY - FLOOR) * (0.5 + 0.5 * lit[:, 2])
    light = direct * (0.35 + 0.65 * openness) + sky * openness
    return np.asarray(np.power(light, GAMMA, dtype=np.float32))
