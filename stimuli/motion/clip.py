"""A clip: one file of captured motion, read and brought to Segue's conventions."""

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from stimuli.errors import InputError
from stimuli.motion import quaternions as quat
from stimuli.motion.formats import READERS
from stimuli.motion.formats.source import Source
from stimuli.motion.loops import closed_cycle
from stimuli.motion.quaternions import Array
from stimuli.motion.resample import resampled
from stimuli.motion.roles import ROLES, missing_roles, resolve_roles
from stimuli.motion.skeleton import Cycle, Motion, Skeleton
from stimuli.motion.units import (
    UPRIGHT,
    is_relative,
    metres_per_unit,
    rest_up,
    upright,
    world_up,
)

WORKING_RATE = 30.0
OVERRIDES = "overrides.toml"
_MOST_REST_POSES = 3


@dataclass(frozen=True, eq=False)
class Clip:
    """A motion at the working rate, with what its file said of itself.

    `frames`, `fps`, `seconds` and `joints` are the file's; `scale` is metres per file unit.
    """

    motion: Motion
    name: str
    path: Path
    format: str
    sha256: str
    frames: int
    fps: float
    seconds: float
    joints: int
    scale: float
    up: str
    roles_missing: tuple[str, ...]
    warnings: tuple[str, ...]


def load(
    path: Path | str,
    *,
    overrides: Path | Mapping[str, Any] | None = None,
    scale: float | str = "auto",
    up: str = "auto",
    fps: float | None = None,
) -> Clip:
    """Read a clip of any known format. InputError when it cannot be used.

    `overrides` (a TOML file or its contents) may hold `scale`, `up`, `fps` and a table `roles`
    of role = joint name; without it `overrides.toml` beside the clip is used when there. The
    keyword arguments rule over both. `fps` is the file's own rate, which AMC files do not carry.
    """
    path = Path(path)
    settings = _settings(path, overrides)
    if scale == "auto":
        scale = settings.get("scale", "auto")
    if up == "auto":
        up = settings.get("up", "auto")
    rate = _rate(settings.get("fps") if fps is None else fps)
    data = _bytes(path)
    reader = _reader(path)
    source = reader(path, data, rate)
    motion, facts = _conform(path, source, scale, up, settings.get("roles", {}))
    return Clip(
        motion=motion,
        name=path.stem,
        path=path,
        format=source.format,
        sha256=sha256(data).hexdigest(),
        frames=len(source.root),
        fps=source.fps,
        seconds=(len(source.root) - 1) / source.fps,
        joints=len(source.names),
        roles_missing=missing_roles(motion.skeleton.roles),
        **facts,
    )


def _bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        why = error.strerror or "unreadable"
        raise InputError(f"{path}: expected a motion clip, found none ({why}).") from None


def _reader(path: Path) -> Callable[[Path, bytes, float | None], Source]:
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(
            f"{path}: expected a clip of a known format ({', '.join(READERS)}), "
            f"found {path.suffix or 'no suffix'}.\nExport the motion as BVH."
        )
    return reader


def _settings(path: Path, overrides: Path | Mapping[str, Any] | None) -> Mapping[str, Any]:
    """Contents of the overrides, checked; those of `overrides.toml` beside the clip by default."""
    if isinstance(overrides, Mapping):
        return _checked(overrides, "overrides")
    beside = path.parent / OVERRIDES
    file = overrides if overrides is not None else beside if beside.is_file() else None
    if file is None:
        return {}
    try:
        return _checked(tomllib.loads(file.read_text(encoding="utf-8")), str(file))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(f"{file}: expected a TOML file of overrides, found {error}.") from None


def _checked(settings: Mapping[str, Any], where: str) -> Mapping[str, Any]:
    roles = settings.get("roles", {})
    faults = [f"{key}: no such setting" for key in settings if key not in
              ("scale", "up", "fps", "roles")]  # fmt: skip
    if not isinstance(roles, Mapping):
        faults.append("roles: expected a table of role = joint")
    else:
        faults += [f"roles.{role}: no such role" for role in roles if role not in ROLES]
    if faults:
        raise InputError(
            f"{where}: {'; '.join(faults)}.\n"
            f"Settings are scale, up, fps and [roles] of {', '.join(ROLES)}."
        )
    return settings


def _rate(fps: Any) -> float | None:
    if fps is None:
        return None
    if isinstance(fps, (int, float)) and 0.1 <= fps <= 100_000:
        return float(fps)
    raise InputError(f"fps: expected frames a second between 0.1 and 100000, found {fps!r}.")


def _conform(
    path: Path, source: Source, scale: float | str, up: str, given: Mapping[str, str]
) -> tuple[Motion, dict[str, Any]]:
    """The motion in metres, +Y up, at the working rate, and what was decided on the way."""
    if unknown := sorted(set(given.values()) - set(source.names)):
        raise InputError(
            f"{path}: overrides name joints that are not there: {', '.join(unknown)}.\n"
            f"Its joints are {', '.join(source.names[:40])}."
        )
    notes = list(source.warnings)
    source, dropped = _without_rest_poses(source)
    if dropped:
        notes.append(f"{dropped} inserted rest pose{'s' * (dropped > 1)} dropped at the start")
    roles = resolve_roles(source.names, source.parents, source.rotations, given)
    rest, doubt = rest_up(source, roles)
    notes += [doubt] if doubt and up == "auto" else []
    if up == "auto":
        up, doubt = world_up(source, roles, rest)
        notes += [doubt] if doubt else []
    elif up not in UPRIGHT:
        raise InputError(f"up: expected auto, Y or Z, found {up!r}.")
    metres, doubt = metres_per_unit(source, roles, scale)
    notes += [doubt] if doubt else []
    root = source.root
    if is_relative(source, roles, up):
        root = root + source.offsets[0]
        notes.append("the root's position channels are relative to its OFFSET: added to it")
    if strays := [f"{name} ({far * metres * 1000:.1f} mm)" for name, far in source.strays.items()
                  if far * metres > 1e-3]:  # fmt: skip
        notes.append(f"positions that vary were replaced by their mean: {', '.join(strays)}")
    skeleton = _skeleton(source, roles, metres, UPRIGHT[rest])
    rotations, root = upright(source.rotations, root * metres, rest, up)
    cycle = _cycle(source, skeleton, rotations, root)
    rotations, root = resampled(rotations, root, source.fps, WORKING_RATE)
    motion = Motion(skeleton, quat.continuous(rotations), root, WORKING_RATE, cycle)
    return motion, {"scale": metres, "up": up, "warnings": tuple(notes)}


def _without_rest_poses(source: Source) -> tuple[Source, int]:
    """Leading frames, at most three, at rest before a frame that is not: dropped."""
    if source.at_rest is None or source.at_rest.all():
        return source, 0
    leading = int(np.argmin(source.at_rest))
    if not 0 < leading <= _MOST_REST_POSES:
        return source, 0
    rest = slice(leading, None)
    return replace(source, rotations=source.rotations[rest], root=source.root[rest]), leading


def _skeleton(source: Source, roles: Mapping[str, int], metres: float, turn: Array) -> Skeleton:
    offsets = quat.rotate(turn, source.offsets) * metres
    offsets[0] = 0.0
    return Skeleton(
        names=source.names,
        parents=source.parents,
        offsets=offsets,
        end_parents=source.end_parents,
        end_offsets=quat.rotate(turn, source.end_offsets) * metres,
        roles=MappingProxyType(dict(roles)),
    )


def _cycle(source: Source, skeleton: Skeleton, rotations: Array, root: Array) -> Cycle | None:
    """The closed cycle of a loop, its period in working frames."""
    if not source.loop or len(root) < 3:
        return None
    return closed_cycle(Motion(skeleton, rotations, root, source.fps), WORKING_RATE)
