"""When a trial was shown too badly to count: the rules that a protocol may name."""

from collections.abc import Callable, Mapping, Sequence

Late = Sequence[Sequence[int]]  # the clip frames that came late, screen by screen
Blends = Sequence[Sequence[tuple[int, int] | None]]  # first and last mixed frame of each clip there
VoidRule = Callable[[Late, Blends], bool]


def late_in_blend(allowed: int, late: Late, blends: Blends) -> bool:
    """A frame came late that the blend of a clip on the screen mixes.

    Where it is unknown which frames those are, any late frame counts.
    """
    return any(
        blend is None or blend[0] <= frame <= blend[1]
        for frames, held in zip(late, blends, strict=False)
        for frame in frames
        for blend in held
    )


def many_late(allowed: int, late: Late, blends: Blends) -> bool:
    """More than `allowed` frames came late."""
    return sum(map(len, late)) > allowed


def never(allowed: int, late: Late, blends: Blends) -> bool:
    """Every trial counts, however it was shown."""
    return False


VOID: Mapping[str, Callable[[int, Late, Blends], bool]] = {
    "late-in-blend": late_in_blend,
    "late-frames": many_late,
    "never": never,
}
