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
SHADE = """
float shade(vec3 normal, float openness, vec3 key, vec3 fill) {
    float wrapped = max((dot(normal, key) + 0.25) / 1.25, 0.0);  // a large source, not a point
    float direct = 0.90 * wrapped * wrapped + 0.14 * max(dot(normal, fill), 0.0);
    float sky = mix(0.07, 0.24, 0.5 + 0.5 * normal.y);
    return pow(direct * (0.35 + 0.65 * openness) + sky * openness, 1.0 / 2.2);
}
"""
LUMINANCE = (0.2126, 0.7152, 0.0722)
_TINT = 0.12  # of a colour's range, that red and blue are moved by a whole tint


def towards(light: tuple[float, float, float], axes: Floats) -> Floats:
    """(3,) unit direction towards a light, for a camera with `axes` (3, 3)."""
    return np.asarray(axes @ (np.array(light) / np.linalg.norm(light)))


def tinted(colour: tuple[float, float, float], sides: Floats, tint: float) -> Floats:
    """(V, 3) colours, cooler where `sides` (V,) is 1 and warmer where it is −1.

    Of one luminance: red and blue go apart, and green makes up for it.
    """
    red, green, blue = LUMINANCE
    way = np.array([-1.0, (red - blue) / green, 1.0]) * _TINT * tint
    return np.clip(np.array(colour) + sides[:, None] * way, 0.0, 1.0)
