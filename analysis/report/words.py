"""Numbers in the style of the American Psychological Association."""

from collections.abc import Sequence

import numpy as np

_MINUS = "−"


def rounded(value: float | None, digits: int = 2) -> str:
    """A number with a true minus sign; an en dash where there is none."""
    if value is None or not np.isfinite(value):
        return "–"
    text = f"{value:.{digits}f}"
    return text.replace("-", _MINUS) if float(text) else text.replace("-", "")


def signed(value: float | None, digits: int = 1) -> str:
    """A number that shows its sign either way."""
    text = rounded(value, digits)
    return text if value is None or not np.isfinite(value) or value <= 0 else f"+{text}"


def share(value: float | None, digits: int = 2) -> str:
    """A number that cannot exceed one, without its leading zero."""
    return rounded(value, digits).replace("0.", ".", 1) if value is not None else "–"


def p_value(p: float | None) -> str:
    """`p = .023`, or `p < .001`."""
    if p is None or not np.isfinite(p):
        return "p not defined"
    return "p < .001" if p < 0.001 else f"p = {share(min(p, 1.0), 3)}"


def interval(low: float | None, high: float | None, digits: int = 2) -> str:
    """`95% CI [low, high]`."""
    return f"95% CI [{rounded(low, digits)}, {rounded(high, digits)}]"


def signed_interval(low: float | None, high: float | None, digits: int = 1) -> str:
    return f"95% CI [{signed(low, digits)}, {signed(high, digits)}]"


def beyond(level: float) -> str:
    """An end that lies beyond the last level shown, signed: `beyond −8`, `beyond +12`."""
    return f"beyond {f'{level:+.10g}'.replace('-', _MINUS)}"


def listing(names: Sequence[str]) -> str:
    """`a, b and c`."""
    if len(names) < 2:
        return "".join(names)
    return f"{', '.join(names[:-1])} and {names[-1]}"


def count(n: int, thing: str, plural: str = "") -> str:
    """`1 trial`, `2,500 trials`, `2 people`."""
    return f"{n:,} {thing if n == 1 else plural or thing + 's'}"


def sentence_case(text: str) -> str:
    return text[:1].upper() + text[1:]
