"""Frames a second, and the times between frames from which files have them."""

from decimal import Decimal
from pathlib import Path

from stimuli.motion.formats.source import fault

SLOWEST, FASTEST = 1.0, 2_000.0  # frames a second of any capture of a whole body
USUAL = (24.0, 25.0, 30.0, 50.0, 60.0, 90.0, 100.0, 120.0)
_SAME_RATE = 1e-3  # rates this near, in proportion, are one


def is_rate(fps: float) -> bool:
    """Whether frames a second are those of a capture."""
    return SLOWEST * (1 - _SAME_RATE) <= fps <= FASTEST * (1 + _SAME_RATE)


def rate(path: Path, frame_time: float, line: int | None = None) -> float:
    """Frames a second of a frame time; within 0.1 % of an integer it is that integer."""
    if not (frame_time > 0 and is_rate(1.0 / frame_time)):
        todo = "Write the seconds between two frames, such as 0.0333333"
        if frame_time > 0 and is_rate(1000.0 / frame_time):
            todo += ", no milliseconds and no rate"
        wanted = f"a frame time of {1 / FASTEST:g} to {1 / SLOWEST:g} seconds"
        raise fault(path, wanted, f"{frame_time:g}", f"{todo}.", line)
    return rounded_rate(1.0 / frame_time)


def rounded_rate(fps: float) -> float:
    """A rate, or the integer that it is within 0.1 % of."""
    near = round(fps)
    return float(near) if near and abs(fps - near) <= _SAME_RATE * near else fps


def written_rate(path: Path, word: str, line: int) -> tuple[float, str | None]:
    """The rate of a frame time as it is written, and a warning where its digits leave it open.

    A time of few digits stands for all that round to it: of these, the usual rate that is nearest.
    """
    as_written = rate(path, float(word), line)
    written = Decimal(word)
    half = 0.5 * 10.0 ** int(written.as_tuple().exponent)
    meant = [fps for fps in USUAL if abs(1.0 / fps - float(written)) <= half * (1 + 1e-9)]
    meant.sort(key=lambda fps: abs(1.0 / fps - float(written)))
    others = " or ".join(f"{fps:g}" for fps in meant if fps != as_written)
    if not others:
        return as_written, None
    if as_written in meant:
        return (
            as_written,
            f"Frame Time {word} is that of {as_written:g} a second; {others} would fit too",
        )
    return meant[0], (
        f"Frame Time {word} would be {as_written:.4g} frames a second; it has so few digits that "
        f"{meant[0]:g} is taken"
    )
