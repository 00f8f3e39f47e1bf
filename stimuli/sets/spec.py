"""What a stimulus set is made of, as a protocol says it; plain frozen data."""

from dataclasses import dataclass, field
from typing import Literal

from stimuli.render.appearance import Appearance


@dataclass(frozen=True)
class Pairing:
    """Two clips and a frame of each: the *from* motion goes over into the *to* motion."""

    name: str
    from_clip: str
    from_frame: int
    to_clip: str
    to_frame: int
    category: str = ""


@dataclass(frozen=True)
class Through:
    """The clips that ways lead through, by patterns of their names, and their graph's threshold."""

    clips: tuple[str, ...]
    tau: float = 1.0


@dataclass(frozen=True)
class SetSpec:
    """A whole set: for each pairing a clip of each method, or of each length around a reference.

    `shorter` and `longer` are absolute differences in frames from the reference length; the
    methods of a pairing are refused whose lengths are less than `methods_apart` frames apart.
    """

    name: str
    pairings: tuple[Pairing, ...]
    specification: str = "start-end"
    methods: tuple[str, ...] = ()
    reference: int | Literal["geodesic"] | None = None
    shorter: tuple[int, ...] = ()
    longer: tuple[int, ...] = ()
    drop_missing: bool = False
    methods_apart: int = 0
    seconds: float = 6.0
    fps: int = 30
    smooth: bool = False
    foot_lock: bool = True
    through: Through | None = None
    appearance: Appearance = field(default_factory=Appearance)
    beside: int = 1  # clips that a screen shows side by side, which decides the best shape

    @property
    def frames(self) -> int:
        """Frames of every clip."""
        return round(self.seconds * self.fps)

    @property
    def middle(self) -> int:
        """The clip frame in which the reference blend has its middle (90 of 180)."""
        return self.frames // 2
