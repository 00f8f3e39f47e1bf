"""A clip: one file of captured motion, read and brought to Segue's conventions."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from stimuli.errors import InputError
from stimuli.motion import quaternions as quat
from stimuli.motion.axes import TO_Y_UP, rest_up, upright, world_up
from stimuli.motion.carrier import carrier, folded
from stimuli.motion.formats import READERS
from stimuli.motion.formats.refused import REFUSED, refusal
from stimuli.motion.formats.source import Take, check_size, contents
from stimuli.motion.loops import closed_cycle
from stimuli.motion.overrides import AUTO, Overrides, overrides_for, roles_given
from stimuli.motion.quaternions import Array
from stimuli.motion.resample import resampled, resampled_length
from stimuli.motion.roles import missing_roles, resolve_roles
from stimuli.motion.shape import shape_roles
from stimuli.motion.skeleton import Cycle, Motion, Skeleton
from stimuli.motion.units import is_relative, metres_per_unit

WORKING_RATE = 30.0
_MOST_REST_POSES = 3


@dataclass(frozen=True, eq=False)
class Clip:
    """A motion at the working rate, with what its file said of itself.

    `frames`, `fps` and `joints` are the file's, inserted rest poses among the frames; `seconds` is
    how long the motion kept lasts, `scale` metres per file unit.
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


def load_clip(
    path: Path | str,
    *,
    overrides: Path | Mapping[str, Any] | None = None,
    scale: float | str = "auto",
    up: str = "auto",
    fps: float | None = None,
) -> Clip:
    """Read a clip of any known format. InputError when it cannot be used.

    `overrides` (a TOML file or its contents) may hold `scale`, `up`, `fps`, a table `roles` of
    role = joint name, and tables `clips.NAME` of the same for the clip of that stem or file name,
    which rule over the general ones; without it `overrides.toml` beside the clip is used when
    there. The keyword arguments rule over both. `fps` is the file's own rate, which AMC files do
    not carry.
    """
    path = Path(path)
    arguments = {"scale": scale, "up": up, "fps": AUTO if fps is None else fps}
    said = overrides_for(path, overrides, arguments)
    data = contents(path)
    take = _reader(path)(path, data, said.fps)
    motion, facts = _conform(path, take, said)
    return Clip(
        motion=motion,
        name=path.stem,
        path=path,
        format=take.format,
        sha256=sha256(data).hexdigest(),
        frames=len(take.root),
        fps=take.fps,
        joints=len(take.names),
        roles_missing=missing_roles(motion.skeleton.roles),
        **facts,
    )


def _reader(path: Path) -> Callable[[Path, bytes, float | None], Take]:
    reader = READERS.get(path.suffix.lower())
    if reader is None and path.suffix.lower() in REFUSED:
        raise refusal(path)
    if reader is None:
        raise InputError(
            f"{path}: expected a clip of a known format ({', '.join(READERS)}), "
            f"found {path.suffix or 'no suffix'}.\nExport the motion as BVH."
        )
    return reader


def _conform(path: Path, take: Take, said: Overrides) -> tuple[Motion, dict[str, Any]]:
    """The motion in metres, +Y up, at the working rate, and what was decided on the way."""
    given, doubts = roles_given(said, path, take.names)
    notes = [*take.warnings, *doubts]
    take, roles, doubts = _with_roles(take, given)
    notes += doubts
    rest, doubt = rest_up(take, roles)
    up = said.up
    if up == AUTO:
        notes += [doubt] if doubt else []
        up, doubt = world_up(take, roles, rest)
        notes += [doubt] if doubt else []
    metres, doubt = metres_per_unit(take, roles, said.scale)
    notes += [doubt] if doubt else []
    root = take.root
    if is_relative(take, roles, up):
        root = root + take.offsets[0]
        notes.append("the root's position channels are relative to its OFFSET: added to it")
    notes += _averaged(take, metres)
    skeleton = _skeleton(take, roles, metres, TO_Y_UP[rest])
    rotations, root = upright(take.rotations, root * metres, rest, up)
    cycle = _cycle(take, skeleton, rotations, root)
    frames = resampled_length(len(root), take.fps, WORKING_RATE)
    check_size(path, frames, len(take.names), WORKING_RATE)
    rotations, root = resampled(rotations, root, take.fps, WORKING_RATE)
    motion = Motion(skeleton, quat.continuous(rotations), root, WORKING_RATE, cycle)
    seconds = (len(take.root) - 1) / take.fps
    return motion, {"seconds": seconds, "scale": metres, "up": up, "warnings": tuple(notes)}


def _with_roles(take: Take, given: Mapping[str, str]) -> tuple[Take, dict[str, int], list[str]]:
    """The motion of the body alone, its roles, and what was decided on the way."""
    notes = []
    roles = _roles(take, given)
    if joint := carrier(take, roles[0] | roles[1]):
        take, note = folded(take, joint)
        notes.append(note)
    take, dropped = _without_rest_poses(take)
    if joint or dropped:
        kept = {role: name for role, name in given.items() if name in take.names}
        roles = _roles(take, kept)
    if dropped:
        notes.append(f"{dropped} inserted rest pose{'s' * (dropped > 1)} dropped at the start")
    known, by_shape = roles
    if by_shape:
        told = ", ".join(f"{role} = {take.names[joint]}" for role, joint in by_shape.items())
        notes.append(f"told from the skeleton's shape, as no name tells it: {told}")
    return take, known | by_shape, notes


def _roles(take: Take, given: Mapping[str, str]) -> tuple[dict[str, int], dict[str, int]]:
    """Roles told from names, and those of the others that the shape tells."""
    known = resolve_roles(take.names, take.parents, take.rotations, given)
    if not missing_roles(known):
        return known, {}
    body = Skeleton(take.names, take.parents, take.offsets, take.end_parents, take.end_offsets)
    return known, shape_roles(body, take.rotations, known)


def _without_rest_poses(take: Take) -> tuple[Take, int]:
    """Leading frames, at most three, at rest before a frame that is not: dropped."""
    if take.at_rest is None or take.at_rest.all():
        return take, 0
    leading = int(np.argmin(take.at_rest))
    if not 0 < leading <= _MOST_REST_POSES:
        return take, 0
    rest = slice(leading, None)
    return replace(
        take,
        rotations=take.rotations[rest],
        root=take.root[rest],
        moves={joint: track[rest] for joint, track in take.moves.items()},
        at_rest=take.at_rest[rest],
    ), leading


def _averaged(take: Take, metres: float) -> list[str]:
    """A warning that names joints whose positions vary, where that is to be seen."""
    strays = {
        take.names[joint]: metres * quat.norm(moves - take.offsets[joint]).max()
        for joint, moves in take.moves.items()
    }
    told = [f"{name} ({far * 1000:.1f} mm)" for name, far in strays.items() if far > 1e-3]
    return [f"positions that vary were replaced by their mean: {', '.join(told)}"] if told else []


def _skeleton(take: Take, roles: Mapping[str, int], metres: float, turn: Array) -> Skeleton:
    offsets = quat.rotate(turn, take.offsets) * metres
    offsets[0] = 0.0
    return Skeleton(
        names=take.names,
        parents=take.parents,
        offsets=offsets,
        end_parents=take.end_parents,
        end_offsets=quat.rotate(turn, take.end_offsets) * metres,
        roles=MappingProxyType(dict(roles)),
    )


def _cycle(take: Take, skeleton: Skeleton, rotations: Array, root: Array) -> Cycle | None:
    """The closed cycle of a loop, its period in working frames."""
    if not take.loop or len(root) < 3:
        return None
    return closed_cycle(Motion(skeleton, rotations, root, take.fps), WORKING_RATE)
