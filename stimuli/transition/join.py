"""What is to be joined, and three plain ways: the cut, the linear blend, by a route."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import Any, NamedTuple

from stimuli.errors import InputError
from stimuli.motion.skeleton import Motion
from stimuli.transition.align import aligned, on_skeleton
from stimuli.transition.blend import blend_linear, spliced
from stimuli.transition.length import Length
from stimuli.transition.route import Route, put_together
from stimuli.transition.smooth import SPREAD_OVER, smoothed_cut
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
    """Frame i of `a` is to be joined with frame j of `b`, which is on the skeleton of `a`.

    By some methods through other motions: then `route` says how, and `held` whether feet that stand
    are held at each of its cuts.
    """

    a: Motion
    b: Motion
    i: int
    j: int
    specification: str
    length: Length
    smooth: bool
    route: Route | None = None
    held: bool = False

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


def join_route(join: Join) -> Joined:
    """A[..i], the pieces of the route, the last of which ends with B[j], then B[j+1..].

    Frames of A up to i stay as they are, unless a foot that stands is eased into being held.
    """
    assert join.route is not None, "a method that goes through other motions is given a route"
    cutting = partial(smoothed_cut, keep=join.i + 1)
    pieces = [
        replace(piece, motion=on_skeleton(piece.motion, join.a.skeleton))
        for piece in join.route.pieces
    ]
    motion, cuts = put_together(join.a[: join.i + 1], pieces, cutting, join.held)
    end = join.i + join.route.frames
    motion = cutting(motion, join.b, end, join.j)
    last = min(max(end, max(cuts) + SPREAD_OVER), len(motion) - 1)
    told = [
        {"clip": piece.clip, "from_frame": piece.first, "to_frame": piece.last}
        for piece in join.route.pieces
    ]
    return Joined(motion, (join.i + 1, last), report=MappingProxyType({"pieces": told}))
