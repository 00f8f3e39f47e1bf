"""How stimuli look: size, background, camera angles, the body and its light. All are settings."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Appearance:
    """Settings of a set's pictures; colours are what the screen shows, 0..1.

    The view `best` is that of the four (front or behind, left or right of the heading) in which
    the figure is largest at the transition, from behind only when it is then much larger: a
    figure that runs off would be tiny from the front.
    """

    width: int = 640
    height: int = 480
    background: tuple[float, float, float] = (0.5, 0.5, 0.5)
    body: str = "figure"  # an entry of stimuli.render.bodies.BODIES
    colour: tuple[float, float, float] = (0.80, 0.76, 0.72)
    azimuth: float = 35.0  # degrees from the line of the heading at the transition
    view: str = "best"  # or an entry of stimuli.render.camera.VIEWS
    elevation: float = 8.0  # degrees above level
    field_of_view: float = 30.0  # degrees, vertical
    margin: float = 0.06  # of the frame left free on each side
