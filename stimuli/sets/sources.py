"""Whether the motion files that a set was built from are still what they were."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from stimuli.errors import InputError
from stimuli.files import sha256
from stimuli.motion.clip import load_clip
from stimuli.sets.naming import motion_digest

Pairings = Mapping[str, Mapping[str, Any]]
PARTED = {".amc"}  # whose bodies lie in another file


def changed_files(pairings: Pairings) -> list[str]:
    """The clips whose file now holds another motion than the one that the manifest tells of.

    A file that is not there any more is no change: sets are carried to machines without motions.
    """
    return [told["clip"] for told in _sources(pairings) if _has_changed(told)]


def changed_motions(before: Pairings, now: Pairings) -> list[str]:
    """The clips that are called as before in two manifests, and are other motions."""
    held = {told["clip"]: told.get("motion") for told in _sources(before)}
    return list(
        dict.fromkeys(
            told["clip"]
            for told in _sources(now)
            if held.get(told["clip"]) not in (None, told["motion"])
        )
    )


def _sources(pairings: Pairings) -> Iterator[Mapping[str, Any]]:
    seen: set[str] = set()
    for pairing in pairings.values():
        for side in ("from", "to"):
            told = pairing.get(side, {})
            if "clip" in told and told["clip"] not in seen:
                seen.add(told["clip"])
                yield told


def _has_changed(told: Mapping[str, Any]) -> bool:
    path = Path(told.get("path", ""))
    if "motion" not in told or not path.is_file():
        return False
    try:
        if path.suffix.lower() not in PARTED and sha256(path) == told["sha256"]:
            return False
        return motion_digest(load_clip(path).motion) != told["motion"]
    except (InputError, OSError):
        return True
