"""One number of a file, in plain ASCII decimal notation.

Python's own readers go beyond that: float() takes 1_000, ١ and nan for numbers, str.isdigit() takes
², and int() raises at thousands of digits.
"""

import re
from collections.abc import Sequence

LARGEST_NUMBER = 1e9  # no position in any unit and no angle comes near it
IN_BOUNDS = "below 1e9"  # as messages say it

# Of any case. Nothing in it is possessive: Python 3.11.2, Debian 12's own, takes a possessive group
# for matched when it failed half-way, and so 1e for a number.
DECIMAL = r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:e[+-]?\d+)?"
_DECIMAL = re.compile(DECIMAL, re.ASCII | re.IGNORECASE)
_COMMENT = re.compile(r"(?<!\S)#")
_WHOLE = re.compile(r"\d{1,15}", re.ASCII)


def is_decimal(word: str) -> bool:
    """Whether a word is a number in decimal notation, of whatever size."""
    return _DECIMAL.fullmatch(word) is not None


def decimal(word: str) -> float | None:
    """The number that a word is; None when it is none, or not within LARGEST_NUMBER."""
    if not is_decimal(word):
        return None
    number = float(word)
    return number if abs(number) < LARGEST_NUMBER else None


def decimals(words: Sequence[str]) -> list[float] | None:
    """The numbers that words are; None when one of them is none, or not within LARGEST_NUMBER."""
    numbers = [number for number in map(decimal, words) if number is not None]
    return numbers if len(numbers) == len(words) else None


def whole_number(word: str) -> int | None:
    """The whole number that a word is; None when it is none, or has more than 15 digits."""
    return int(word) if _WHOLE.fullmatch(word) else None


def without_comment(line: str) -> str:
    """A line without what follows a # that begins a word; that in -1.#IND is no such."""
    return _COMMENT.split(line, maxsplit=1)[0]
