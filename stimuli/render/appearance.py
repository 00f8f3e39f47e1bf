"""How stimuli look: size, background, camera angles, the body and its light. All are settings."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Appearance:
    """Settings of a set's pictures; colours are what the screen shows, 0..1.

    Without an azimuth it is three-quarter, from the front or, where a figure that travels far is
    then much larger at the transition, from behind.
    """

    width: int = 640
    height: int = 480
    background: tuple[float, float, float] = (0.5, 0.5, 0.5)
    body: str = "figure"  # an entry of stimuli.render.bodies.BODIES
    colour: tuple[float, float, float] = (0.80, 0.76, 0.72)
    azimuth: float | None = None  # degrees from the heading at the transition, to its left
    elevation: float = 8.0  # degrees above level
    field_of_view: float = 30.0  # degrees, vertical
    margin: float = 0.06  # of the frame left free on each side
