"""A group of clips planned: every clip laid out, one body, one camera, and what goes on record."""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stimuli.errors import InputWarning
from stimuli.motion.clip import Clip
from stimuli.motion.library import Library
from stimuli.render.appearance import Appearance
from stimuli.render.bodies import Body, bone_motion, make_body
from stimuli.render.camera import Camera
from stimuli.render.clip import group_camera
from stimuli.sets.ends import end_displacements, picture_displacements
from stimuli.sets.frames import Scenery
from stimuli.sets.layout import LaidOut, lay_out
from stimuli.sets.naming import RECIPE, clip_names, joining, motion_digest, same_pictures
from stimuli.sets.plan import ResolvedPairing, place_of, resolve_pairing
from stimuli.sets.refusals import together
from stimuli.sets.spec import Pairing, SetSpec
from stimuli.transition.measures import transition_measures


@dataclass(frozen=True, eq=False)
class PlannedClip:
    """A clip before it is rendered: its name, what is drawn, its entry in the manifest so far."""

    hash: str
    laid_out: LaidOut
    bones: NDArray[np.float32]  # (F, B, 8) what is drawn: how the body's bones move
    document: Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class PlannedGroup:
    """The clips of a pairing."""

    resolved: ResolvedPairing
    body: Body
    scenery: Scenery
    clips: tuple[PlannedClip, ...]
    document: Mapping[str, Any]

    @property
    def name(self) -> str:
        """The pairing's name."""
        return self.resolved.name

    @property
    def look(self) -> Appearance:
        """How the whole set looks."""
        return self.scenery.look

    @property
    def camera(self) -> Camera:
        """The camera that holds the figure in all clips."""
        return self.scenery.camera


def plan_group(spec: SetSpec, resolved: ResolvedPairing, library: Library) -> PlannedGroup:
    """Lay out every clip of a pairing and find the camera that holds the figure in all of them.

    RefusedError, which names the pairing, of all that its clips lack.
    """
    laid, body = together(
        [partial(_laid_out, spec, resolved, library)], place_of(spec, resolved.pairing)
    )[0]
    return _group(spec, resolved, library, laid, body)


def plan_groups(spec: SetSpec, library: Library) -> tuple[PlannedGroup, ...]:
    """Every group of a set, or all that they are refused for together, before any work."""

    def planned(pairing: Pairing) -> PlannedGroup:
        return plan_group(spec, resolve_pairing(spec, pairing, library), library)

    return tuple(together(partial(planned, pairing) for pairing in spec.pairings))


def _laid_out(
    spec: SetSpec, resolved: ResolvedPairing, library: Library
) -> tuple[list[LaidOut], Body]:
    """The clips of a pairing in time, and their body."""
    clips: list[LaidOut] = []
    bodies: list[Body] = []

    def lay(method: str | None, length: int) -> None:
        at_length = None if method else length
        clips.append(lay_out(spec, resolved, library, method=method, length=at_length))

    def dress() -> None:
        source = library.load(resolved.pairing.from_clip)
        bodies.append(_body(source, spec.appearance.body))

    works: list[Callable[[], None]] = [dress]
    works += [partial(lay, *kind) for kind in _kinds(resolved)]
    together(works)
    return clips, bodies[0]


def _kinds(resolved: ResolvedPairing) -> list[tuple[str | None, int]]:
    """The method (None: a set by lengths) and the length of each clip."""
    return [*resolved.methods.items(), *((None, length) for length in resolved.lengths)]


def _group(
    spec: SetSpec,
    resolved: ResolvedPairing,
    library: Library,
    laid: Sequence[LaidOut],
    body: Body,
) -> PlannedGroup:
    look, pairing = spec.appearance, resolved.pairing
    kinds = _kinds(resolved)
    camera = group_camera(body, [clip.motion for clip in laid], look, laid[0].at)
    names = _names(spec, resolved, library, laid)
    reference = next(
        clip for (_, length), clip in zip(kinds, laid, strict=True) if length == resolved.anchor
    )

    def planned(method: str | None, clip: LaidOut, name: str) -> PlannedClip:
        measures = {
            **transition_measures(clip.transition, reference.transition),
            **end_displacements(clip, reference),
            **picture_displacements(clip, reference, camera),
        }
        document = _clip_document(spec, resolved, method, clip, measures)
        return PlannedClip(name, clip, bone_motion(body, clip.motion), document)

    clips = tuple(
        planned(method, clip, name)
        for (method, _), clip, name in zip(kinds, laid, names, strict=True)
    )
    if len({clip.hash for clip in clips}) < len(clips):
        _warn_of_copies(spec, pairing.name, kinds, clips)
    scenery = Scenery(pairing.name, body.skin, camera, look)
    document = _group_document(resolved, library, camera, body)
    return PlannedGroup(resolved, body, scenery, clips, document)


def _names(
    spec: SetSpec, resolved: ResolvedPairing, library: Library, laid: Sequence[LaidOut]
) -> list[str]:
    """Names of a group's clips in order; clips that nobody could tell apart have one name."""
    pairing = resolved.pairing
    firsts = same_pictures([clip.motion for clip in laid])
    made_of = {
        "from": [motion_digest(library.load(pairing.from_clip).motion), pairing.from_frame],
        "to": [motion_digest(library.load(pairing.to_clip).motion), pairing.to_frame],
        "specification": spec.specification,
        "smooth": spec.smooth,
        "foot_lock": spec.foot_lock,
        "at": laid[0].at,
        "frames": spec.frames,
        "fps": spec.fps,
        "appearance": asdict(spec.appearance),
    }
    return clip_names(made_of, [joining(laid[first].transition) for first in firsts])


def _warn_of_copies(
    spec: SetSpec,
    pairing: str,
    kinds: Sequence[tuple[str | None, int]],
    clips: Sequence[PlannedClip],
) -> None:
    """Clips that are one and the same compare nothing: name what they are of."""
    names = [method or f"length {length}" for method, length in kinds]
    for hash_ in dict.fromkeys(clip.hash for clip in clips):
        alike = [name for name, clip in zip(names, clips, strict=True) if clip.hash == hash_]
        if len(alike) > 1:
            warnings.warn(
                f"set {spec.name}, {pairing}: {' and '.join(alike)} make one and the same clip, "
                "which compares nothing; choose other frames",
                InputWarning,
                stacklevel=4,
            )


def _clip_document(
    spec: SetSpec,
    resolved: ResolvedPairing,
    method: str | None,
    clip: LaidOut,
    measures: Mapping[str, float | None],
) -> dict[str, Any]:
    """A clip's entry in the manifest, but for what its file holds."""
    remark = resolved.remarks.get(method) if method else None
    return {
        "motion": resolved.name,
        "method": method,
        "specification": spec.specification,
        "length": clip.transition.frames,
        "smooth": spec.smooth,
        "foot_lock": spec.foot_lock,
        "transition_frame": clip.at,
        "mixed": list(clip.mixed),
        "first_altered": clip.altered,
        "measures": {
            key: value if value is None else round(value, 6) for key, value in measures.items()
        },
        "report": _plain(clip.transition.report),
        "warnings": [remark] if remark else [],
        "recipe": RECIPE,
        "appearance": asdict(spec.appearance),
    }


def _group_document(
    resolved: ResolvedPairing, library: Library, camera: Camera, body: Body
) -> dict[str, Any]:
    pairing = resolved.pairing

    def source(name: str, frame: int) -> dict[str, Any]:
        clip = library.load(name)
        return {
            "clip": name,
            "path": str(clip.path),
            "sha256": clip.sha256,
            "motion": motion_digest(clip.motion),
            "frame": frame,
        }

    return {
        "category": pairing.category,
        "reference_length": resolved.reference_length,
        "lengths": list(resolved.lengths),
        "methods": dict(resolved.methods),
        "from": source(pairing.from_clip, pairing.from_frame),
        "to": source(pairing.to_clip, pairing.to_frame),
        "camera": asdict(camera),
        "body": {
            "reference_frame": body.rig.reference.frame,
            "neck_tilt": round(float(np.degrees(body.rig.reference.neck_tilt)), 2),
            "head_pitch": round(float(np.degrees(body.rig.reference.head_pitch)), 2),
        },
    }


def _plain(report: Mapping[str, Any]) -> dict[str, Any]:
    """What JSON can hold of a method's report: words, finite numbers, pieces; not whole curves."""
    values = {
        key: value.item() if isinstance(value, np.generic) else value
        for key, value in report.items()
    }
    return {
        key: value
        for key, value in values.items()
        if isinstance(value, bool | int | str)
        or (isinstance(value, float) and np.isfinite(value))
        or key == "pieces"
    }


_BODIES: dict[tuple[str, str], Body] = {}


def _body(clip: Clip, style: str) -> Body:
    """The body of a clip's skeleton, made once for a file and style in a process."""
    key = (clip.sha256, style)
    if key not in _BODIES:
        _BODIES[key] = make_body(clip.motion, style)
    return _BODIES[key]
