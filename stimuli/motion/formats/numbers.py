"""A long run of decimal numbers, parsed in one call.

Without their points decimal numbers are whole ones, which are read several times as fast; one
multiplication or division by a power of ten then gives the correctly rounded number, as long as
the mantissa is below 2⁵³ and the power at most 22. A few numbers beyond are read one by one; a text
of anything else goes through NumPy's parser of decimals.
"""

import re
import warnings
from pathlib import Path

import numpy as np

from stimuli.motion.formats.source import fault, shown
from stimuli.motion.formats.words import (
    DECIMAL,
    IN_BOUNDS,
    LARGEST_NUMBER,
    decimal,
    is_decimal,
)
from stimuli.motion.quaternions import Array

_TODO = "The file is damaged; export it again."
_POINT, _SPACE, _ZERO, _PLUS, _MINUS = np.frombuffer(b". 0+-", dtype=np.uint8)
_SMALL, _CAPITAL = b"eE"
_AS_SPACE = bytes.maketrans(b"eE", b"  ")
_MOST_EXACT = 2**53  # a larger mantissa is rounded before it is scaled
_POWERS = 10.0 ** np.arange(23)  # the powers of ten that a double holds exactly
_FEW = 0.02  # of all numbers, read one by one
_LARGEST_EXPONENT = 400  # beyond it every number is 0 or too large
# possessive, so that a word which is no number is met once and not tried in pieces
_ALL_DECIMALS = re.compile(rf"\s*+(?:{DECIMAL}(?:\s++|\Z))*+", re.ASCII | re.IGNORECASE)


def parse_numbers(path: Path, text: str, start: int) -> Array:
    """All numbers of `text` from `start` on; InputError with line and word where one is none."""
    return numbers_and_ends(path, text, start)[0]


def numbers_and_ends(path: Path, text: str, start: int) -> tuple[Array, np.ndarray | None]:
    """The same, and where in `text` the word of each ends, if that came to light in passing."""
    words = _words(text[start:])
    numbers, ends = words or (_any_notation(path, text, start), None)
    if not np.all(np.abs(numbers) < LARGEST_NUMBER):
        raise _culprit(path, text, start)
    return numbers, None if ends is None else ends + (start - 1)


def words_in_lines(text: str, start: int) -> np.ndarray:
    """How many words each line (N,) of ASCII text has from `start` on."""
    return np.array([len(line.split()) for line in text[start:].split("\n")])


def scaled_mantissas(text: str) -> Array | None:
    """Numbers read as whole mantissas times powers of ten; None when there is anything else."""
    words = _words(text)
    return None if words is None else words[0]


def _words(text: str) -> tuple[Array, np.ndarray] | None:
    """Such numbers, and behind which letter of a blank and the text each of them ends."""
    try:
        data = f" {text} ".encode("ascii")
    except UnicodeEncodeError:
        return None
    codes = np.frombuffer(data, dtype=np.uint8)
    inside = codes > _SPACE
    letters = _letters(data, codes)
    inside[letters] = False  # an exponent counts as a word of its own, and is read as one
    ends = np.flatnonzero(inside[:-1] > inside[1:]) + 1
    whole = _whole_numbers(data.translate(_AS_SPACE, b"."))
    if whole is None or len(whole) != len(ends) or not _end_in_digits(codes, ends):
        return None
    points = np.flatnonzero(codes == _POINT)
    behind = codes[points + 1]
    if np.any((behind == _PLUS) | (behind == _MINUS)):  # without its point, a sign like any other
        return None
    decimals = _decimals(points, ends)
    if decimals is None:
        return None
    if len(letters):
        owners = np.searchsorted(ends, letters)
        exponents = owners + 1
        sound = inside[letters - 1] & inside[letters + 1]
        if not np.all(sound) or np.any(np.diff(owners) == 1):
            return None
        if np.any(decimals[exponents]) or np.any(codes[ends[exponents] - 1] == _POINT):
            return None
        if _largest(whole[exponents]) > _LARGEST_EXPONENT:
            return None
        decimals[owners] -= whole[exponents]
        ends[owners] = ends[exponents]
        number = np.ones(len(whole), dtype=bool)
        number[exponents] = False
        whole, decimals, ends = whole[number], decimals[number], ends[number]
    numbers = _scaled(whole, decimals, data, ends)
    return None if numbers is None else (numbers, ends)


def _end_in_digits(codes: np.ndarray, ends: np.ndarray) -> bool:
    """Whether every word does, points apart: NumPy takes a sign alone for the next word's."""
    last = codes[ends - 1]
    digits = last - _ZERO <= 9  # wraps around below 0
    return bool(np.all(digits | ((last == _POINT) & (codes[ends - 2] - _ZERO <= 9))))


def _letters(data: bytes, codes: np.ndarray) -> np.ndarray:
    """Where the exponents' letters stand."""
    if b"e" not in data and b"E" not in data:
        return np.empty(0, dtype=np.intp)
    return np.flatnonzero((codes == _SMALL) | (codes == _CAPITAL))


def _decimals(points: np.ndarray, ends: np.ndarray) -> np.ndarray | None:
    """Digits behind the point of every word; None where a word has two points."""
    if len(points) == len(ends) and np.all(points < ends) and np.all(points[1:] > ends[:-1]):
        return np.asarray(ends - points - 1)
    decimals = np.zeros(len(ends), dtype=np.int64)
    words = np.searchsorted(ends, points)
    if np.any(words[1:] == words[:-1]):
        return None
    decimals[words] = ends[words] - points - 1
    return decimals


def _scaled(whole: np.ndarray, decimals: np.ndarray, data: bytes, ends: np.ndarray) -> Array | None:
    """whole / 10^decimals, correctly rounded; None where too many numbers need another way."""
    beyond: np.ndarray = np.empty(0, dtype=np.intp)
    if _largest(whole) >= _MOST_EXACT or _largest(decimals) >= len(_POWERS):
        large = (whole >= _MOST_EXACT) | (whole <= -_MOST_EXACT)  # the least has no magnitude
        beyond = np.flatnonzero(large | (np.abs(decimals) >= len(_POWERS)))
        if len(beyond) > _FEW * len(whole):
            return None
        decimals[beyond] = 0
    if decimals.min() >= 0:
        numbers = whole / _POWERS[decimals]
    else:
        scale = _POWERS[np.abs(decimals)]
        numbers = np.where(decimals < 0, whole * scale, whole / scale)
    for place in beyond:
        before = ends[place - 1] if place else 0
        try:
            numbers[place] = float(data[before : ends[place]])
        except ValueError:
            return None
    return np.asarray(numbers)


def _largest(values: np.ndarray) -> int:
    """The largest magnitude of whole numbers."""
    return max(int(values.max()), -int(values.min()))


def _whole_numbers(data: bytes) -> np.ndarray | None:
    """Whole numbers between blanks; None when there is anything else."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(data, dtype=np.int64, sep=" ")
        except (DeprecationWarning, ValueError):
            return None


def _any_notation(path: Path, text: str, start: int) -> Array:
    if not _ALL_DECIMALS.fullmatch(text, start):  # NumPy would take 1-2 for two numbers
        raise _culprit(path, text, start)
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text[start:], sep=" ")
        except (DeprecationWarning, ValueError):
            raise _culprit(path, text, start) from None


def _culprit(path: Path, text: str, start: int) -> Exception:
    """The fault of the first word that is no usable number."""
    for word in re.finditer(r"\S+", text[start:]):
        if decimal(word[0]) is None:
            line = text.count("\n", 0, start + word.start()) + 1
            wanted = f"a number {IN_BOUNDS}" if is_decimal(word[0]) else "a number"
            return fault(path, wanted, shown(word[0]), _TODO, line)
    return fault(path, "plain decimal numbers", "another notation", _TODO)
