"""A long run of decimal numbers, parsed in one call.

Exporters write all their numbers with as many digits behind the point (a 0 may stand alone).
Without the points those are whole numbers, which are read three times as fast; one division by a
power of ten gives the correctly rounded number where the mantissa is below 2⁵³. Any other notation
goes through NumPy's parser of decimals.
"""

import re
import warnings
from pathlib import Path

import numpy as np

from stimuli.motion.formats.source import LARGEST_NUMBER, fault, shown
from stimuli.motion.quaternions import Array

_TODO = "The file is damaged; export it again."
_FIRST = re.compile(r"\S")
_POINT, _ZERO, _SPACE = b".0 "
_MOST_DECIMALS = 15


def parse_numbers(path: Path, text: str, start: int) -> Array:
    """All numbers of `text` from `start` on; InputError with line and word where one is none."""
    first = _FIRST.search(text, start)
    line_end = text.find("\n", first.start()) if first else -1
    rest = even_decimals(text[line_end:]) if line_end >= 0 else None
    if rest is None:
        numbers = _any_notation(path, text, start)
    else:  # an inserted rest pose in the first line is printed otherwise
        numbers = np.concatenate([_any_notation(path, text[:line_end], start), rest])
    if not np.all(np.abs(numbers) < LARGEST_NUMBER):
        raise _culprit(path, text, start)
    return numbers


def even_decimals(text: str) -> Array | None:
    """Numbers with as many digits behind the point each; None when there is anything else."""
    try:
        codes = np.frombuffer(f" {text} ".encode("ascii"), dtype=np.uint8)
    except UnicodeEncodeError:
        return None
    points = np.flatnonzero(codes == _POINT)
    if not len(points):
        return None
    blank = codes <= _SPACE
    decimals = int(np.argmax(blank[points[0] + 1 : points[0] + 2 + _MOST_DECIMALS]))
    if not (decimals and points[-1] + decimals + 1 < len(codes)):
        return None
    if not np.all(blank[points + decimals + 1]) or np.any(np.diff(points) <= decimals):
        return None
    lone_zeros = np.count_nonzero((codes[1:-1] == _ZERO) & blank[:-2] & blank[2:])
    mantissas = _whole_numbers(text.replace(".", ""))
    if mantissas is None or len(mantissas) != len(points) + lone_zeros:
        return None
    if np.abs(mantissas).max() >= 2**53:
        return None
    return np.asarray(mantissas / 10.0**decimals)


def _whole_numbers(text: str) -> np.ndarray | None:
    """Whole numbers between blanks; None when there is anything else."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text, dtype=np.int64, sep=" ")
        except (DeprecationWarning, ValueError):
            return None


def _any_notation(path: Path, text: str, start: int) -> Array:
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text[start:], sep=" ")
        except (DeprecationWarning, ValueError):
            raise _culprit(path, text, start) from None


def _culprit(path: Path, text: str, start: int) -> Exception:
    """The fault of the first word that is no usable number."""
    for word in re.finditer(r"\S+", text[start:]):
        try:
            usable = abs(float(word[0])) < LARGEST_NUMBER
        except ValueError:
            usable = False
        if not usable:
            line = text.count("\n", 0, start + word.start()) + 1
            return fault(path, "a number", shown(word[0]), _TODO, line)
    return fault(path, "plain decimal numbers", "another notation", _TODO)
