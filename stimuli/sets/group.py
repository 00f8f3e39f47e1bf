"""Groups of clips planned: every clip laid out, a body, one camera, and what goes on record.

Where the look leaves the camera or the shape of the pictures open, one choice is made for all
groups of a set, from what the figure does in all of them.
"""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
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
from stimuli.render.clip import ground_motions
from stimuli.render.ground import GroundMotion
from stimuli.render.staging import Settled, Staging, settle, sizes, stage
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
    ground: GroundMotion | None
    document: Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class PlannedGroup:
    """The clips of a pairing; the look is that of the whole set, with nothing left open."""

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


@dataclass(frozen=True, eq=False)
class _LaidGroup:
    """The clips of a pairing laid out, with the methods or lengths that they are of."""

    resolved: ResolvedPairing
    kinds: tuple[tuple[str | None, int], ...]
    laid: tuple[LaidOut, ...]
    body: Body
    bones: tuple[NDArray[np.float32], ...]
    staging: Staging


def plan_groups(spec: SetSpec, library: Library) -> list[PlannedGroup]:
    """All groups of a set, under one look; says what was chosen where that was left open.

    RefusedError of all that any of them is refused for, before any work.
    """

    def laid(pairing: Pairing) -> _LaidGroup:
        return _laid_group(spec, resolve_pairing(spec, pairing, library), library)

    groups = together(partial(laid, pairing) for pairing in spec.pairings)
    settled = settle(spec.appearance, [group.staging for group in groups], spec.beside)
    for remark in settled.remarks:
        warnings.warn(f"set {spec.name}: {remark}", InputWarning, stacklevel=2)
    return [
        _planned_group(spec, group, library, settled, camera)
        for group, camera in zip(groups, settled.cameras, strict=True)
    ]


def plan_group(spec: SetSpec, resolved: ResolvedPairing, library: Library) -> PlannedGroup:
    """One group by itself, as if the set had no other."""
    group = _laid_group(spec, resolved, library)
    settled = settle(spec.appearance, [group.staging], spec.beside)
    return _planned_group(spec, group, library, settled, settled.cameras[0])


def _laid_group(spec: SetSpec, resolved: ResolvedPairing, library: Library) -> _LaidGroup:
    """The clips of a pairing in time, and their body; RefusedError of all that they lack."""
    kinds = (*resolved.methods.items(), *((None, length) for length in resolved.lengths))
    laid: list[LaidOut] = []
    bodies: list[Body] = []

    def lay(method: str | None, length: int) -> None:
        at_length = None if method else length
        laid.append(lay_out(spec, resolved, library, method=method, length=at_length))

    def dress() -> None:
        source = library.load(resolved.pairing.from_clip)
        bodies.append(_body(source, spec.appearance))

    works: list[Callable[[], None]] = [dress]
    works += [partial(lay, *kind) for kind in kinds]
    together(works, place_of(spec, resolved.pairing))
    body, motions = bodies[0], [clip.motion for clip in laid]
    bones = tuple(bone_motion(body, motion) for motion in motions)
    staging = stage(body, motions, bones, laid[0].at, [clip.mixed for clip in laid])
    return _LaidGroup(resolved, kinds, tuple(laid), body, bones, staging)


def _planned_group(
    spec: SetSpec, group: _LaidGroup, library: Library, settled: Settled, camera: Camera
) -> PlannedGroup:
    resolved, kinds, laid, body = group.resolved, group.kinds, group.laid, group.body
    look = settled.look
    names = _names(spec, resolved, library, laid, look)
    reference = next(
        clip for (_, length), clip in zip(kinds, laid, strict=True) if length == resolved.anchor
    )
    grounds = ground_motions(body, [clip.motion for clip in laid], group.bones, look)

    def drawn(clip: LaidOut) -> LaidOut:
        return replace(clip, motion=body.shown(clip.motion))

    def document(method: str | None, clip: LaidOut) -> dict[str, Any]:
        measures = {
            **transition_measures(clip.transition, reference.transition),
            **end_displacements(clip, reference),
            **picture_displacements(drawn(clip), drawn(reference), camera, look.picture_degrees),
        }
        return _clip_document(spec, resolved, method, clip, measures)

    clips = tuple(
        PlannedClip(name, clip, bones, ground, document(method, clip))
        for (method, _), clip, bones, ground, name in zip(
            kinds, laid, group.bones, grounds, names, strict=True
        )
    )
    if len({clip.hash for clip in clips}) < len(clips):
        _warn_of_copies(spec, resolved.name, kinds, clips)
    scenery = Scenery(resolved.name, body.skin, camera, look)
    told = _group_document(resolved, library, camera, body)
    told["figure"] = figure_document(look, camera, group.staging)
    return PlannedGroup(resolved, body, scenery, clips, told)


def figure_document(look: Appearance, camera: Camera, staging: Staging) -> dict[str, float]:
    """How large a figure is that stands where it is: shares of the picture, degrees of angle.

    Least within a second of the blend, and anywhere; the degrees are those of the picture as it
    is meant to be seen, `middle` is where the figure stands on average, 0 being the top.
    """
    shown = sizes(camera, staging)
    half = np.tan(np.radians(look.picture_degrees / 2))
    degrees = {
        f"{key}_degrees": 2 * float(np.degrees(np.arctan(half * share)))
        for key, share in (("near_blend", shown.near_blend), ("anywhere", shown.anywhere))
    }
    found = {"near_blend": shown.near_blend, "anywhere": shown.anywhere, "middle": shown.middle}
    return {key: round(value, 3) for key, value in (found | degrees).items()}


def _names(
    spec: SetSpec,
    resolved: ResolvedPairing,
    library: Library,
    laid: Sequence[LaidOut],
    look: Appearance,
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
        "appearance": asdict(look),
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
                stacklevel=5,
            )


def _clip_document(
    spec: SetSpec,
    resolved: ResolvedPairing,
    method: str | None,
    clip: LaidOut,
    measures: Mapping[str, float | None],
) -> dict[str, Any]:
    """A clip's entry in the manifest, but for its file; its `appearance` is what was asked for."""
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


_BODIES: dict[tuple[str, Appearance], Body] = {}


def _body(clip: Clip, look: Appearance) -> Body:
    """The body of a clip's skeleton, made once for a file and look in a process."""
    key = (clip.sha256, look)
    if key not in _BODIES:
        _BODIES[key] = make_body(clip.motion, look)
    return _BODIES[key]
