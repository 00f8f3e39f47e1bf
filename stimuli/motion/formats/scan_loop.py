"""The loop of a scan, compiled: imported where it is called, since Numba takes a while to load."""

import numpy as np

from stimuli.compiled import compiled, inlined
from stimuli.motion.formats.scan_state import (
    BEGINS,
    ENDED,
    FULL,
    LINES,
    NO_NUMBER,
    ODD_BEGINS,
    ODD_LINE,
    ODD_LINES,
    ODD_WORDS,
    PLACE,
    POWERS,
    UNCERTAIN,
    WORDS,
    Codes,
    State,
)
from stimuli.motion.quaternions import Array

_EXACT = np.uint64(1 << 53)
_MOST = np.uint64(10**18)  # with one digit more it still fits
_TEN = np.uint64(10)
_SPLIT = 134217729.0  # 2²⁷ + 1, Veltkamp's


@inlined
def _is_blank(code: int) -> bool:
    """Whether a character of ASCII is one at which `str.split` parts words."""
    return code == 32 or 9 <= code <= 13 or 28 <= code <= 31


@inlined
def _end_line(state: State, usual: int) -> None:
    """Counts the line that ends, unless there are no words in it."""
    if state[WORDS] == 0:
        return
    state[LINES] += 1
    if state[WORDS] != usual:
        if state[ODD_LINES] == 0:
            state[ODD_BEGINS] = state[BEGINS]
            state[ODD_LINE], state[ODD_WORDS] = state[LINES], state[WORDS]
        state[ODD_LINES] += 1
    state[WORDS] = 0


@inlined
def _number(codes: Codes, place: int, high: Array, low: Array) -> tuple[int, float, int]:
    """Where the word at `place` ends, the number that it is, and FULL; or why it is none."""
    size = len(codes)
    negative = codes[place] == 45
    if negative or codes[place] == 43:
        place += 1
    place, mantissa, digits, spare, cut = _digits(codes, place, np.uint64(0), False)
    power = spare
    if place < size and codes[place] == 46:
        place, mantissa, behind, spare, lost = _digits(codes, place + 1, mantissa, cut)
        power += spare - behind
        digits += behind
        cut = lost
    if digits == 0:
        return place, 0.0, NO_NUMBER
    if place < size and (codes[place] == 101 or codes[place] == 69):
        place += 1
        down = place < size and codes[place] == 45
        if place < size and (down or codes[place] == 43):
            place += 1
        first, written = place, 0
        while place < size and 48 <= codes[place] <= 57:
            if written < 100_000:  # beyond it every number is 0 or too large
                written = written * 10 + int(codes[place]) - 48
            place += 1
        if place == first:
            return place, 0.0, NO_NUMBER
        power += -written if down else written
    if place < size and not _is_blank(codes[place]):
        return place, 0.0, NO_NUMBER
    value, certain = _value(mantissa, power, cut, high, low)
    if not certain:
        return place, 0.0, UNCERTAIN
    if not value < 1e9:
        return place, 0.0, NO_NUMBER
    return place, -value if negative else value, FULL


@inlined
def _digits(
    codes: Codes, place: int, mantissa: np.uint64, cut: bool
) -> tuple[int, np.uint64, int, int, bool]:
    """Digits from `place` on, joined to `mantissa`: where they end, what has become of it, how many
    they are, how many of them found no room in it, and whether any of all these was not 0."""
    first, spare = place, 0
    while place < len(codes) and 48 <= codes[place] <= 57:
        if mantissa < _MOST:
            mantissa = mantissa * _TEN + np.uint64(codes[place] - 48)
        else:
            cut = cut or codes[place] != 48
            spare += 1
        place += 1
    return place, mantissa, place - first, spare, cut


@inlined
def _value(
    mantissa: np.uint64, power: int, cut: bool, high: Array, low: Array
) -> tuple[float, bool]:
    """mantissa · 10^power, or a little more if cut; and whether it surely is the nearest double."""
    if mantissa == 0:
        return 0.0, True
    if mantissa < _EXACT and not cut:
        if 0 <= power <= 22:
            return float(mantissa) * high[power + POWERS], True
        if -22 <= power < 0:
            return float(mantissa) / high[POWERS - power], True
    if power < -POWERS or power > POWERS:
        return 0.0, False
    value, certain = _scaled(mantissa, power, high, low)
    if cut and certain:
        above, certain = _scaled(mantissa + np.uint64(1), power, high, low)
        certain = certain and above == value
    return value, certain


@compiled(nogil=True)
def _scaled(mantissa: np.uint64, power: int, high: Array, low: Array) -> tuple[float, bool]:
    """mantissa · 10^power by double-doubles (Dekker 1971), and whether its rounding is certain."""
    upper = float(mantissa >> np.uint64(32)) * 4294967296.0
    lower = float(mantissa & np.uint64(0xFFFFFFFF))
    m = upper + lower
    rest = lower - (m - upper)
    h = high[power + POWERS]
    product = m * h
    split = _SPLIT * m
    m1 = split - (split - m)
    m2 = m - m1
    split = _SPLIT * h
    h1 = split - (split - h)
    h2 = h - h1
    error = ((m1 * h1 - product) + m1 * h2 + m2 * h1) + m2 * h2
    error += m * low[power + POWERS] + rest * h
    nearest = product + error
    left = error - (nearest - product)
    doubt = nearest * 3e-30  # a hundred times what the steps above may be off
    return nearest, nearest + (left + doubt) == nearest and nearest + (left - doubt) == nearest


@compiled(nogil=True)
def fill(
    codes: Codes, state: State, values: Array, usual: int, high: Array, low: Array
) -> tuple[int, int]:
    """Why the scan stops, and how many of `values` it has filled; see `scan`."""
    place, count, size = state[PLACE], 0, len(codes)
    why = FULL
    while True:
        while place < size and _is_blank(codes[place]):
            if codes[place] == 10 or codes[place] == 13:
                _end_line(state, usual)
            place += 1
        if place >= size:
            _end_line(state, usual)
            why = ENDED
            break
        if count == len(values):
            break
        end, value, why = _number(codes, place, high, low)
        if why != FULL:
            break
        values[count] = value
        count += 1
        if state[WORDS] == 0:
            state[BEGINS] = place
        state[WORDS] += 1
        place = end
    state[PLACE] = place
    return why, count
