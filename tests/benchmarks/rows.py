"""A row of the table: what was measured, beside a rival in the same run, and what is asked of it.

What is asked is a ratio to the rival, which a machine half as fast leaves as it is, and seconds
only where somebody waits for them, said as such.
"""

from typing import Any


def row(
    name: str,
    value: float,
    unit: str,
    rival: str | None = None,
    rival_value: float | None = None,
    *,
    faster: float | None = None,
    felt: float | None = None,
) -> dict[str, Any]:
    """A row; met when the rival takes `faster` times as much, or nobody waits more than `felt`.

    `felt` is in the row's unit. None where nothing is asked, or the rival is not there.
    """
    ratio = None if rival_value is None else rival_value / value
    met: bool | None = None
    if felt is not None:
        met = value <= felt
    elif faster is not None and ratio is not None:
        met = ratio >= faster
    asked = None
    if felt is not None:
        asked = f"{felt:g} {unit} felt"
    elif faster is not None:
        asked = f"{faster:g} ×"
    return {
        "name": name,
        "value": value,
        "unit": unit,
        "rival": rival,
        "rival_value": rival_value,
        "ratio": ratio,
        "target": asked,
        "met": met,
    }
