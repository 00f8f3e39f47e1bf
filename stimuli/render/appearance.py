"""How stimuli look: size, background, camera, ground, style and its light. All are settings."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

SHAPES: Mapping[str, float] = {"4:3": 4 / 3, "16:9": 16 / 9}  # of pictures: width over height
STANDARD_DOTS = ("head", "shoulders", "elbows", "wrists", "hips", "knees", "ankles")


@dataclass(frozen=True)
class Appearance:
    """Settings of a set's pictures; colours are what the screen shows, 0..1.

    A picture is `height` pixels high and as wide as its `shape` says, unless a `width` is given.
    `shape` "best" and `camera` "auto" are chosen from what the figure does: `settled` looks have
    neither (see `stimuli.render.staging.settle`).
    """

    width: int = 0  # pixels; 0: as the shape has it
    height: int = 720
    shape: str = "best"  # or an entry of SHAPES
    picture_degrees: float = 20.0  # of visual angle that the height is meant to be seen under
    background: tuple[float, float, float] = (0.5, 0.5, 0.5)
    supersample: int = 1  # pictures drawn so many times as large, and averaged
    camera: str = "auto"  # or an entry of stimuli.render.staging.CAMERAS
    direction: float | None = None  # degrees from the heading at the transition; None: the best
    elevation: float = 8.0  # degrees above level
    # degrees, vertical: as seen from where the picture has 20 degrees, its perspective is right
    field_of_view: float = 20.0
    margin: float = 0.02  # of the frame left free on each side
    ground: str = "none"  # or another entry of stimuli.render.ground.GROUNDS
    style: str = "figure"  # an entry of stimuli.render.bodies.STYLES
    colour: tuple[float, float, float] = (0.80, 0.76, 0.72)
    thickness: float = 1.0  # of limbs and sticks, as a multiple of the style's own
    tint: float = 0.0  # 0..1, how far the left limbs are made cooler and the right ones warmer
    proportions: str = "captured"  # or another entry of stimuli.render.proportions.PROPORTIONS
    foot_roll: float | None = None  # degrees that a foot may roll on its shank; None: as captured
    dots: tuple[str, ...] = STANDARD_DOTS  # where a point-light walker has them
    dot_size: float = 0.25  # their diameter
    dot_unit: str = "degrees"  # of visual angle, or "metres"
    control: str = "none"  # or another entry of stimuli.render.pointlight.CONTROLS
    control_seed: int = 0  # of the draws that scramble

    @property
    def settled(self) -> bool:
        """Whether the camera and the size of the picture are known."""
        return self.camera != "auto" and self.width > 0

    def shaped(self, shape: str) -> "Appearance":
        """This look with pictures of a shape, unless their width is given."""
        if self.width:
            return self
        return replace(self, width=2 * round(self.height * SHAPES[shape] / 2), shape=shape)
