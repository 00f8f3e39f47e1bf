"""What is to be joined, and two plain ways of joining: the cut and the linear blend."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, NamedTuple

from stimuli.errors import InputError
from stimuli.motion.skeleton import Motion
from stimuli.transition.align import aligned
from stimuli.transition.blend import blend_linear, spliced
from stimuli.transition.length import Length
from stimuli.transition.window import Fits, Window, longest_fitting, specified


class Joined(NamedTuple):
    """What a way of joining makes: the motion, and its first and last frame that are mixed.

    `played` are A and B where they were joined at another pace than captured; `report` says what
    the way of joining settled by itself.
    """

    motion: Motion
    mixed: tuple[int, int]
    played: tuple[Motion, Motion] | None = None
    report: Mapping[str, Any] = MappingProxyType({})


@dataclass(frozen=True, eq=False)
class Join:
    """Frame i of `a` is to be joined with frame j of `b`, which is on the skeleton of `a`."""

    a: Motion
    b: Motion
    i: int
    j: int
    specification: str
    length: Length
    smooth: bool

    @property
    def window(self) -> Window:
        """The frames that the specification mixes."""
        return specified(self.specification)(self.i, self.j, self.length.frames)

    def fitting_window(self, fits: Fits = Window.fits) -> Window:
        """The same; InputError where the motions lack frames that a way of joining needs."""
        if self.length.frames < 1 or not fits(self.window, self.a, self.b):
            longest = longest_fitting(
                self.a, self.b, self.i, self.j, self.specification, fits, most=len(self.a)
            )
            raise InputError(
                f"{self.specification} blend {self.i} → {self.j}: expected a length from 1 to "
                f"{longest} frames, found {self.length.frames}.\n"
                "Choose a shorter blend or frames farther from the ends."
            )
        return self.window

    def brought(self, window: Window) -> Motion:
        """`b` with the heading and floor position of `a` where the window is anchored."""
        return aligned(self.a, self.b, window.anchor, window.anchor + window.lag)


def join_cut(join: Join) -> Joined:
    """A[..i], then B[j+1..], with B[j] aligned to A[i]."""
    if join.length.frames:
        raise InputError(f"cut: expected no frames of blend, found {join.length.frames}.")
    b = aligned(join.a, join.b, join.i, join.j)
    here = slice(join.i, join.i + 1)
    motion = spliced(join.a, b, join.i, join.j + 1, join.a.rotations[here], join.a.root[here])
    return Joined(motion, (join.i, join.i))


def join_linear(join: Join) -> Joined:
    """Slerp and linear interpolation over the window of the specification."""
    window = join.fitting_window()
    motion = blend_linear(join.a, join.brought(window), window, join.smooth)
    return Joined(motion, (window.first, window.last))
