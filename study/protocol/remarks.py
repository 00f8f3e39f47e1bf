"""What a protocol may say, but hides something of what is shown: told, not refused."""

import warnings
from collections.abc import Iterator, Mapping
from typing import Any

from stimuli.errors import InputWarning
from study.protocol.faults import Fault, table_at, tell_faults


def remarks(document: Mapping[str, Any]) -> Iterator[Fault]:
    """Of a protocol without faults, what its writer may not have meant."""
    look = table_at(document, "appearance")
    ground, style = look.get("ground", "none"), look.get("style", "figure")
    if look.get("camera") == "follow" and (ground == "none" or ground == "shadow"):
        has = "no ground" if ground == "none" else "a ground without marks"
        message = (
            f"a camera that follows hides, with {has}, the way that a figure makes over the "
            'floor; ground = "grid" shows it'
        )
        yield Fault(("appearance", "camera"), message)
    if style != "point-light":
        for key in ("dots", "dot_size", "dot_unit", "control", "control_seed"):
            if key in look:
                message = f'only the style "point-light" has it, found the style "{style}"'
                yield Fault(("appearance", key), message)


def tell_remarks(document: Mapping[str, Any], text: str, where: str) -> None:
    """Warn of them, each with its line."""
    for remark in remarks(document):
        warnings.warn(tell_faults([remark], text, where), InputWarning, stacklevel=4)
