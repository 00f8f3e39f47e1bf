"""A long run of decimal numbers, parsed in one call.

Motion files are mostly numbers such as -12.3456. Those are read eight digits at a time in whole
arrays: eight characters are one 64-bit word, whose digits three multiplications add up. The result
is correctly rounded, since a mantissa below 2⁵³ is divided once by an exact power of ten. Other
notations (exponents, more digits) go through NumPy's own parser.
"""

import re
import warnings
from pathlib import Path

import numpy as np

from stimuli.motion.formats.source import LARGEST_NUMBER, fault, shown
from stimuli.motion.quaternions import Array

_TODO = "The file is damaged; export it again."
_MOST_DIGITS = 15
_BLOCK = 1 << 15  # bytes: what is computed of them stays in the cache
_POWERS = 10.0 ** np.arange(_MOST_DIGITS + 2)
_KEEP_LAST = np.array([((1 << 8 * k) - 1) << (64 - 8 * k) for k in range(9)], dtype=np.uint64)
_ZEROS = np.uint64(0x3030303030303030)
_STEPS = tuple(
    (np.uint64(factor), np.uint64(shift), np.uint64(mask))
    for factor, shift, mask in (
        (10, 8, 0x00FF00FF00FF00FF),
        (100, 16, 0x0000FFFF0000FFFF),
        (10_000, 32, 0x00000000FFFFFFFF),
    )
)


def parse_numbers(path: Path, text: str, start: int) -> Array:
    """All numbers of `text` from `start` on; InputError with line and word where one is none."""
    numbers = plain_decimals(text[start:])
    if numbers is None:
        numbers = _any_notation(path, text, start)
    if not np.all(np.abs(numbers) < LARGEST_NUMBER):
        raise _culprit(path, text, start)
    return numbers


def plain_decimals(text: str) -> Array | None:
    """The numbers of a text of plain decimals; None when it holds anything else."""
    try:
        data = b"        " + text.encode("ascii") + b" "
    except UnicodeEncodeError:
        return None
    blocks = []
    start = 8
    while start < len(data):
        end = _block_end(data, start)
        block = _plain_block(data[start - 8 : end])
        if block is None:
            return None
        blocks.append(block)
        start = end
    return np.concatenate(blocks) if blocks else np.empty(0)


def _block_end(data: bytes, start: int) -> int:
    """Just after the first blank at least a block's length from `start`: no number is split."""
    end = start + _BLOCK
    while end < len(data) and data[end - 1] > 32:
        end += 1
    return min(end, len(data))


def _plain_block(data: bytes) -> Array | None:
    """The numbers of a block of which the first 8 bytes belong to what is before it."""
    codes = np.frombuffer(data, dtype=np.uint8)
    blank = codes <= 32
    blank[:8] = True
    edges = np.flatnonzero(blank[1:] != blank[:-1]) + 1
    starts, ends = edges[::2], edges[1::2]
    is_dot = codes == 46
    is_dot[:8] = False
    negative = codes[starts] == 45
    digits = np.count_nonzero(codes[8:] - np.uint8(48) < 10)
    others = np.count_nonzero(blank[8:]) + np.count_nonzero(is_dot) + np.count_nonzero(negative)
    if digits + others != len(codes) - 8:
        return None
    points = _points(edges, is_dot)
    if points is None:
        return None
    whole, part = points - starts - negative, np.maximum(ends - points - 1, 0)
    count = whole + part
    if len(starts) and (whole.max() > 8 or count.min() < 1 or count.max() > _MOST_DIGITS):
        return None
    words = np.ndarray((len(data) - 7,), dtype="<u8", buffer=data, strides=(1,))
    if len(starts) and (ends - starts - negative).max() <= 8:
        mantissa = _value(_without_point(words[ends - 8] ^ _ZEROS, whole, part, points < ends))
    else:
        mantissa = _digits(words, points, whole) * _POWERS[part]
        mantissa += _digits(words, ends, np.minimum(part, 8))
        if len(part) and part.max() > 8:
            mantissa += _digits(words, np.maximum(ends - 8, 8), np.maximum(part - 8, 0)) * 1e8
    values = mantissa / _POWERS[part]
    return np.where(negative, -values, values)


def _without_point(
    word: np.ndarray, whole: np.ndarray, part: np.ndarray, pointed: np.ndarray
) -> np.ndarray:
    """Words that end with a number of at most 8 characters: its digits alone, drawn together."""
    behind = _KEEP_LAST[part]
    after_whole = part + pointed
    before = _KEEP_LAST[whole + after_whole] & ~_KEEP_LAST[after_whole]
    return ((word & before) << (pointed * np.uint64(8))) | (word & behind)


def _points(edges: np.ndarray, is_dot: np.ndarray) -> np.ndarray | None:
    """Where each number's decimal point is, or its end; None when one has two."""
    ends, dots = edges[1::2], np.flatnonzero(is_dot)
    if len(dots) == len(ends) and np.all(dots < ends) and np.all(dots >= edges[::2]):
        return dots
    held = np.add.reduceat(is_dot, edges, dtype=np.uint8)[::2] if len(edges) else is_dot[:0]
    if len(held) and held.max() > 1:
        return None
    points = ends.copy()
    points[held.astype(bool)] = dots
    return points


def _digits(words: np.ndarray, ends: np.ndarray, count: np.ndarray) -> Array:
    """The numbers that the `count` (at most 8) digits before each end spell."""
    return _value((words[ends - 8] ^ _ZEROS) & _KEEP_LAST[count])


def _value(word: np.ndarray) -> Array:
    """The numbers that eight digits (0 to 9, the first in the lowest byte) spell."""
    for factor, shift, mask in _STEPS:
        word = (word * factor + (word >> shift)) & mask
    return word.astype(np.float64)


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
