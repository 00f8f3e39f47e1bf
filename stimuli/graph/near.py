"""Editing by demand: an earlier answer, and how much of it changed demands leave alone."""

from collections.abc import Mapping, Sequence
from typing import Any

from stimuli.collection import Collection
from stimuli.errors import InputError
from stimuli.graph.demands import Demands
from stimuli.graph.plan import Stretch


def near_answer(
    answer: Mapping[str, Any], demands: Demands, collection: Collection
) -> tuple[list[Stretch], int]:
    """The pieces of an earlier answer, and until when they need not change.

    That is the last body demand before the first demand that is new, gone or another. 0 where
    nothing was changed, or what is so counts from the beginning: then all may be bettered.
    """
    try:
        pieces = [
            Stretch(
                collection.place(entry["clip"]), int(entry["from_frame"]), int(entry["to_frame"]),
                float(entry["cut_cost"]),
            )
            for entry in answer["pieces"]
        ]  # fmt: skip
        before = [dict(entry) for entry in answer["demands"]]
    except (KeyError, TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            "--near: expected an answer that `segue graph search` wrote, found one without its "
            "pieces or demands."
        ) from error
    now = [{"kind": demand.kind, **demand.values} for demand in demands.demands]
    changed = [entry for entry in now if entry not in before]
    changed += [entry for entry in before if entry not in now]
    if not changed:
        return pieces, 0
    first = min(_from(entry) for entry in changed)
    anchors = [body["at"] for body in demands.of("body") if body["at"] < first]
    return pieces, max(anchors, default=0)


def _from(entry: Mapping[str, Any]) -> int:
    """The time from which on a demand counts; places to avoid count from the beginning."""
    return int(entry.get("at", entry.get("from", 0)))


def kept_pieces(one: Sequence[Stretch], other: Sequence[Stretch]) -> int:
    """How many pieces at the beginning of two answers are the same."""
    count = 0
    for a, b in zip(one, other, strict=False):
        if (a.clip, a.first, a.last) != (b.clip, b.first, b.last):
            break
        count += 1
    return count
