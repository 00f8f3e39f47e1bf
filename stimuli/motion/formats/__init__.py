"""Readers of motion files, one a format, in a table by suffix; each returns a `Take`."""

from collections.abc import Callable, Mapping
from pathlib import Path

from stimuli.motion.formats.acclaim import read_acclaim, refuse_asf
from stimuli.motion.formats.amass import read_amass
from stimuli.motion.formats.bvh import read_bvh
from stimuli.motion.formats.deepmimic import read_deepmimic
from stimuli.motion.formats.refused import refuse
from stimuli.motion.formats.source import Take

Reader = Callable[[Path, bytes, float | None], Take]

READERS: Mapping[str, Reader] = {
    ".bvh": read_bvh,
    ".amc": read_acclaim,
    ".asf": refuse_asf,
    ".c3d": refuse,
    ".npz": read_amass,
    ".json": read_deepmimic,
    ".txt": read_deepmimic,
}

__all__ = ["READERS", "Reader", "Take"]
