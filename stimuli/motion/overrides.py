"""What a person says of a clip where its file misleads: scale, up axis, rate, roles of joints.

A file of overrides holds settings for all clips and, in tables [clips.NAME], for single ones, which
rule over them. It is checked whole, whichever clip is being read.
"""

import reprlib
import tomllib
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from numbers import Real
from pathlib import Path
from typing import Any

from stimuli.errors import InputError, InputWarning
from stimuli.motion.axes import TO_Y_UP
from stimuli.motion.formats.rates import FASTEST, SLOWEST, is_rate
from stimuli.motion.roles import ROLES

OVERRIDES = "overrides.toml"
AUTO = "auto"
_HELP = (
    f"Settings are scale, up, fps, [roles] of {', '.join(ROLES)}; "
    '[clips.NAME] or [clips."NAME.bvh"] holds those of one clip.'
)


@dataclass(frozen=True)
class Overrides:
    """Settings of one clip; "auto" leaves to the file what it tells.

    `roles` (role → joint) are meant for this clip, `usual_roles` for all clips of a directory,
    some of which may lack such a joint.
    """

    scale: float | str
    up: str
    fps: float | None
    roles: Mapping[str, str]
    usual_roles: Mapping[str, str]


def overrides_for(
    path: Path, given: Path | Mapping[str, Any] | None, arguments: Mapping[str, Any]
) -> Overrides:
    """What is said of the clip at `path`; InputError naming all faults at once.

    `given` is a file or its contents, else OVERRIDES beside the clip is taken when there;
    `arguments` (scale, up, fps) rule over both.
    """
    beside = path.parent / OVERRIDES
    usual = given is None and beside.is_file()
    document = _document(beside if usual else given)
    _refuse(str(path), _faults(arguments))
    clips = document.get("clips", {})
    if usual and clips:
        _warn_of_strangers(beside, _state(beside), _state(path.parent))
    own = [clips[name] for name in (path.stem, path.name) if name in clips]
    layers = [document, *own, {k: v for k, v in arguments.items() if v != AUTO}]
    said = {key: value for layer in layers for key, value in layer.items()}
    general = document.get("roles", {})
    roles = {role: joint for layer in own for role, joint in layer.get("roles", {}).items()}
    fps = said.get("fps", AUTO)
    return Overrides(
        scale=said.get("scale", AUTO),
        up=said.get("up", AUTO),
        fps=None if fps == AUTO else float(fps),
        roles=roles if usual else general | roles,
        usual_roles={k: v for k, v in general.items() if k not in roles} if usual else {},
    )


def roles_given(
    overrides: Overrides, path: Path, names: tuple[str, ...]
) -> tuple[dict[str, str], list[str]]:
    """Role → joint as said of a clip with joints `names`, and warnings.

    InputError when a role meant for this clip names a joint that is not there.
    """
    if unknown := sorted(set(overrides.roles.values()) - set(names)):
        raise InputError(
            f"{path}: overrides name joints that are not there: {', '.join(unknown)}.\n"
            f"Its joints are {', '.join(names[:40])}."
        )
    usual = overrides.usual_roles
    kept = {role: joint for role, joint in usual.items() if joint in names}
    absent = [f"{joint} ({role})" for role, joint in usual.items() if role not in kept]
    notes = [f"no joint {', '.join(absent)} of {OVERRIDES} here: told from the names instead"]
    return kept | dict(overrides.roles), notes if absent else []


def _document(given: Path | Mapping[str, Any] | None) -> Mapping[str, Any]:
    """The settings, all of them sound."""
    if given is None or isinstance(given, Mapping):
        _refuse("overrides", _faults_of_document(given or {}))
        return given or {}
    try:
        return _parsed(Path(given), _state(Path(given)))
    except OSError as error:
        raise _unreadable(given, error) from None


@lru_cache(maxsize=64)
def _parsed(path: Path, state: tuple[int, ...]) -> Mapping[str, Any]:
    """The settings of a file in that state: read once for all the clips beside it."""
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise _unreadable(path, error) from None
    _refuse(str(path), _faults_of_document(document))
    return document


def _state(path: Path) -> tuple[int, ...]:
    """What changes when a file or directory does."""
    found = path.stat()
    return found.st_dev, found.st_ino, found.st_mtime_ns, found.st_size


def _unreadable(path: Path, error: Exception) -> InputError:
    return InputError(f"{path}: expected a TOML file of overrides, found {error}.")


def _refuse(where: str, faults: list[str]) -> None:
    if faults:
        raise InputError(f"{where}: {'; '.join(faults)}.\n{_HELP}")


def _faults_of_document(document: Mapping[str, Any]) -> list[str]:
    clips = document.get("clips", {})
    if not isinstance(clips, Mapping):
        clips = {"": clips}
    faults = _faults({key: value for key, value in document.items() if key != "clips"})
    for name, settings in clips.items():
        place = f"clips.{name}" if name else "clips"
        if isinstance(settings, Mapping):
            faults += _faults(settings, f"{place}.")
        else:
            faults.append(_unlike(place, "a table of settings", settings))
    return faults


def _faults(settings: Mapping[str, Any], within: str = "") -> list[str]:
    """What is wrong with settings, each with its key."""
    faults = []
    for key, value in settings.items():
        if key in _CHECKS:
            faults += _CHECKS[key](within + key, value)
        else:
            faults.append(f"{within}{key}: no such setting")
    return faults


def _check_scale(place: str, value: Any) -> list[str]:
    fits = value == AUTO or (_is_number(value) and 1e-6 < value < 1e6)
    return [] if fits else [_unlike(place, "auto or metres per file unit, 1e-6 to 1e6", value)]


def _check_up(place: str, value: Any) -> list[str]:
    fits = isinstance(value, str) and value in (AUTO, *TO_Y_UP)
    return [] if fits else [_unlike(place, f"auto or {' or '.join(TO_Y_UP)}", value)]


def _check_fps(place: str, value: Any) -> list[str]:
    fits = value == AUTO or (_is_number(value) and is_rate(value))
    wanted = f"auto or frames a second, {SLOWEST:g} to {FASTEST:g}"
    return [] if fits else [_unlike(place, wanted, value)]


def _check_roles(place: str, value: Any) -> list[str]:
    if not isinstance(value, Mapping):
        return [_unlike(place, "a table of role = joint", value)]
    strange = [f"{place}.{role}: no such role" for role in value if role not in ROLES]
    return strange + [
        _unlike(f"{place}.{role}", "the name of a joint", joint)
        for role, joint in value.items()
        if not isinstance(joint, str)
    ]


_CHECKS: Mapping[str, Callable[[str, Any], list[str]]] = {
    "scale": _check_scale,
    "up": _check_up,
    "fps": _check_fps,
    "roles": _check_roles,
}


def _is_number(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)


def _unlike(place: str, expected: str, found: Any) -> str:
    return f"{place}: expected {expected}, found {reprlib.repr(found)}"


@lru_cache(maxsize=64)
def _warn_of_strangers(path: Path, state: tuple[int, ...], of_directory: tuple[int, ...]) -> None:
    """InputWarning when a table's name is no clip's: it would be without effect, in silence.

    Said of a file once, not with each of the clips beside it; again when either has changed.
    """
    there = {name for found in path.parent.iterdir() for name in (found.stem, found.name)}
    if absent := [name for name in _parsed(path, state).get("clips", {}) if name not in there]:
        told = f"{path} names clips that are not there: {', '.join(absent)}"
        warnings.warn(told, InputWarning, stacklevel=2)
