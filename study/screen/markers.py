"""Markers of a session as a stream of Lab Streaming Layer, for hardware that records beside it.

One marker an event, a word or two of text, stamped by the clock of LSL when the screen flipped:
`trial 3 start`, `trial 3 screen 1` (its first frame), `trial 3 question`, `trial 3 answer 1`.
"""

from collections.abc import Callable

from stimuli.errors import InputError

Mark = Callable[[str, float], None]  # what happened, and how many seconds ago
STREAM, KIND = "Segue", "Markers"


def unmarked(text: str, ago: float = 0.0) -> None:
    """Nobody listens."""


def open_markers(source: str) -> Mark:
    """A stream of markers, open; `source` names it, so that a recorder finds it again.

    Raises InputError where the library pylsl, or the one that it calls, cannot be loaded.
    """
    try:
        import pylsl
    except (ImportError, RuntimeError, OSError) as error:
        raise InputError(
            f"presentation.markers: expected the library pylsl, found none that loads ({error});\n"
            "`pip install 'segue[lsl]'`, or leave markers out of the protocol"
        ) from error
    info = pylsl.StreamInfo(STREAM, KIND, 1, pylsl.IRREGULAR_RATE, pylsl.cf_string, source)
    outlet = pylsl.StreamOutlet(info)

    def mark(text: str, ago: float = 0.0) -> None:
        outlet.push_sample([text], pylsl.local_clock() - ago)

    return mark
