"""Long runs of decimal numbers by NumPy alone, before it is worth while to load compiled loops.

A decimal of at most fifteen digits is a whole number divided by a power of ten, and one division
rounds it as the standard asks; NumPy reads whole numbers seven times faster than decimals.
"""

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from stimuli.motion.formats.scan_state import Codes
from stimuli.motion.formats.words import LARGEST_NUMBER
from stimuli.motion.quaternions import Array

_OF_NUMBERS = b"0123456789+-.eE \t\r\n"
_OF_DECIMALS = b"0123456789-. \t\r\n"
_DOT, _MINUS = b".-"
_MOST_DIGITS = 15  # as whole numbers they are exact in a double
_TENS = 10.0 ** np.arange(_MOST_DIGITS + 1)


def plain_blocks(data: bytes, start: int, size: int, usual: int) -> Iterator[Array]:
    """The same as `number_blocks` by NumPy, of a text whose lines have `usual` words each.

    `size` is how many numbers a block has, about. ValueError at what is no such line, which is for
    `number_blocks` to read or to refuse.
    """
    for piece in _pieces(data, start, 8 * size):
        rows = _decimals(piece, usual)
        if rows is None:
            rows = _floats(piece, usual)
        if not np.all(np.abs(rows) < LARGEST_NUMBER):
            raise ValueError("a number out of bounds")
        if len(rows):
            yield rows


def _pieces(data: bytes, start: int, size: int) -> Iterator[bytes]:
    """Whole lines of a text, about `size` bytes at a time."""
    mark = b"\n" if data.find(b"\n", start) >= 0 else b"\r"
    while start < len(data):
        end = data.find(mark, min(start + size, len(data)))
        end = len(data) if end < 0 else end + 1
        yield data[start:end]
        start = end


def _decimals(text: bytes, usual: int) -> Array | None:
    """The numbers of lines of plain decimals; None where there is more to read than these."""
    if text.translate(None, _OF_DECIMALS):
        return None
    codes = np.frombuffer(b"\n" + text + b"\n", dtype=np.uint8)
    blank = codes <= ord(" ")
    edges = np.flatnonzero(blank[1:] != blank[:-1]) + 1
    begins, ends = edges[::2], edges[1::2]
    if not len(begins):
        return np.empty(0)
    negative = codes[begins] == _MINUS
    dots = np.flatnonzero(codes == _DOT)
    dotted = np.searchsorted(begins, dots, side="right") - 1
    digits = ends - begins - negative
    digits[dotted] -= 1
    signs_within = np.count_nonzero(codes == _MINUS) > np.count_nonzero(negative)
    if signs_within or np.any(dotted[1:] == dotted[:-1]):  # or two dots in one word
        return None
    if digits.min() < 1 or digits.max() > _MOST_DIGITS:
        return None
    _check_lines(codes, begins, usual)
    behind = np.zeros(len(begins), dtype=np.intp)
    behind[dotted] = ends[dotted] - dots - 1
    values = np.fromstring(text.replace(b".", b""), dtype=np.int64, sep=" ") / _TENS[behind]
    values[negative] = -np.abs(values[negative])  # also 0
    return values


def _check_lines(codes: Codes, begins: npt.NDArray[np.intp], usual: int) -> None:
    """ValueError unless each line with words has `usual` of them."""
    line_ends = np.flatnonzero((codes == ord("\n")) | (codes == ord("\r")))
    words = np.diff(np.searchsorted(begins, line_ends))
    if np.any(words[words > 0] != usual):
        raise ValueError("another layout")


def _floats(text: bytes, usual: int) -> Array:
    """The numbers of lines of any that Python's `float` reads in digits."""
    if text.translate(None, _OF_NUMBERS):
        raise ValueError("something else than numbers")
    lines = [line for line in text.decode("ascii").splitlines() if line.strip()]
    if not lines:
        return np.empty(0)
    rows = np.loadtxt(lines, comments=None, ndmin=2)
    if rows.shape[1] != usual:
        raise ValueError("another layout")
    return rows.ravel()
