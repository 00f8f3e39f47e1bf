"""The log of a session's flips: a row a refresh while clips are shown, beside the record.

`trial`, `screen` (of the trial) and `frame` (of the clip) say what was shown, `flip` when: seconds
from the first flip of its screen, whose `unix_time` stands in its row alone. `due` stands where a
frame is shown for the first time, in the same seconds. What a row does not say is n/a.
"""

from collections.abc import Sequence
from pathlib import Path

from stimuli.errors import UnwritableError
from study.record.table import MISSING
from study.screen.playing import Flip

FLIP_COLUMNS = ("trial", "screen", "frame", "due", "flip", "unix_time")


def log_flips(
    path: Path, trial: str, screen: int, flips: Sequence[Flip], rate: float, to_wall: float
) -> None:
    """Append the flips of one screen; `rate` in Hz, `to_wall` what makes their times Unix ones.

    Raises UnwritableError.
    """
    first = flips[0].at
    lines = [
        "\t".join((
            trial, str(screen), str(flip.frame),
            MISSING if flip.due is None else f"{flip.due / rate:.4f}",
            f"{flip.at - first:.4f}",
            MISSING if n else f"{first + to_wall:.4f}",
        ))
        for n, flip in enumerate(flips)
    ]  # fmt: skip
    try:
        with path.open("ab+") as stream:
            lead = "" if stream.tell() else "\t".join(FLIP_COLUMNS) + "\n"
            if stream.tell():
                stream.seek(-1, 2)
                lead = "" if stream.read() == b"\n" else "\n"  # after a line that a kill tore
            stream.write((lead + "\n".join(lines) + "\n").encode())
    except OSError as error:
        raise UnwritableError(
            f"{path}: the flips of {trial} could not be written: {error.strerror or error}"
        ) from error
