"""What a study of a protocol's [observer] comes to: measured in one, expected over many."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from study.protocol.protocol import Protocol
    from study.trials.tasks.task import Held

_MIDDLE = (2.5, 97.5)  # percent: between them lie 95 of 100 studies


def _held(protocol: "Protocol") -> "Iterator[Held]":
    from study.trials.tasks import TASKS

    if protocol.file.observer is not None:
        yield from TASKS[protocol.file.task].holds(protocol.file, protocol.file.observer)


def measured(protocol: "Protocol", study: Mapping[str, Any]) -> dict[str, float]:
    """What one simulated study says of each thing that the protocol's observer holds.

    A threshold is that of the report's fit, all else the mean of the rows that tell of it.
    """
    if "estimates" in study:
        return {f"threshold {e.side}": e.value for e in study["estimates"] if e.ok}
    rows = study["table"].to_dict("records")
    found = {}
    for held in _held(protocol):
        told = [value for row in rows if (value := held.told(row)) is not None]
        if told:
            found[held.what] = float(np.mean(told))
    return found


def expected(protocol: "Protocol", studies: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Each thing that the observer holds: its truth, and mean, SD and middle 95 % of studies."""
    rows = []
    for held in _held(protocol):
        told = [s["measured"][held.what] for s in studies if held.what in s["measured"]]
        found = np.array(told, float)
        row: dict[str, Any] = {"what": held.what, "truth": held.truth, "studies": len(found)}
        if len(found) > 1:
            low, high = (float(v) for v in np.percentile(found, _MIDDLE))
            row |= {"mean": float(found.mean()), "sd": float(found.std(ddof=1)),
                    "low": low, "high": high}  # fmt: skip
        rows.append(row)
    return rows
