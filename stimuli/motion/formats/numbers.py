"""A long run of decimal numbers, parsed in one call."""

import re
import warnings
from pathlib import Path

import numpy as np

from stimuli.motion.formats.source import LARGEST_NUMBER, fault, shown
from stimuli.motion.quaternions import Array

_TODO = "The file is damaged; export it again."


def parse_numbers(path: Path, text: str, start: int) -> Array:
    """All numbers of `text` from `start` on; InputError with line and word where one is none."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            numbers = np.fromstring(text[start:], sep=" ")
        except (DeprecationWarning, ValueError):
            raise _culprit(path, text, start) from None
    if not np.all(np.abs(numbers) < LARGEST_NUMBER):
        raise _culprit(path, text, start)
    return numbers


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
    return fault(path, "numbers", "something else", _TODO)
