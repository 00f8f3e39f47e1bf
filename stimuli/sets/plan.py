"""Which blend lengths a set means: reference lengths computed, differences turned into lengths."""

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from itertools import combinations

from stimuli.errors import InputError, InputWarning
from stimuli.motion.library import Library
from stimuli.sets.refusals import together
from stimuli.sets.spec import Pairing, SetSpec
from stimuli.sets.ways import way_of
from stimuli.transition import METHODS, Length, blend_length, with_room
from stimuli.transition.distance import check_pair


@dataclass(frozen=True)
class ResolvedPairing:
    """A pairing with the lengths of its clips, in frames.

    `reference_length` is None when no length is a reference (a set by methods); `lengths` are
    those of a set by lengths, ascending; `methods` maps each method to its length.
    """

    pairing: Pairing
    reference_length: int | None
    lengths: tuple[int, ...]
    methods: Mapping[str, int]
    remarks: Mapping[str, str] = field(default_factory=dict)  # by method

    @property
    def name(self) -> str:
        """The pairing's name."""
        return self.pairing.name

    @property
    def anchor(self) -> int:
        """The length that the layout in time goes by: the reference, or the first method's."""
        return (
            next(iter(self.methods.values()))
            if self.reference_length is None
            else self.reference_length
        )


def resolve(spec: SetSpec, library: Library) -> tuple[ResolvedPairing, ...]:
    """The lengths of every pairing; nothing is rendered.

    RefusedError, of all pairings at once, for clips that cannot be found or joined, for methods
    that choose nearly one length, and for lengths below 1 unless `spec.drop_missing`, which drops
    them with a warning.
    """
    return tuple(together(partial(resolve_pairing, spec, each, library) for each in spec.pairings))


def resolve_pairing(spec: SetSpec, pairing: Pairing, library: Library) -> ResolvedPairing:
    """The lengths of one pairing; RefusedError names it."""

    def resolved() -> ResolvedPairing:
        together(partial(_refuse, fault) for fault in _faults(pairing, library))
        return _resolved(spec, pairing, library)

    return together([resolved], place_of(spec, pairing))[0]


def place_of(spec: SetSpec, pairing: Pairing) -> str:
    """What is said before a fault of a pairing."""
    return f"set {spec.name}, {pairing.name}: "


def _refuse(fault: str) -> None:
    raise InputError(fault)


def _resolved(spec: SetSpec, pairing: Pairing, library: Library) -> ResolvedPairing:
    if spec.reference is None:
        if not spec.methods:
            raise InputError("expected methods or a reference length, found neither.")
        chosen = {method: chosen_length(spec, pairing, library, method) for method in spec.methods}
        lengths = {method: length.frames for method, length in chosen.items()}
        _refuse_alike(lengths, spec.methods_apart)
        faults = {
            method: f"the {method} length was clamped to {length.frames} frames"
            for method, length in chosen.items()
            if length.report.get("clamped")
        }
        return ResolvedPairing(pairing, None, (), lengths, faults)
    reference = (
        chosen_length(spec, pairing, library, "geodesic").frames
        if spec.reference == "geodesic"
        else spec.reference
    )
    return ResolvedPairing(pairing, reference, _lengths(spec, pairing, reference), {})


def _refuse_alike(lengths: Mapping[str, int], apart: int) -> None:
    """A motion whose methods give nearly the same length compares nothing: InputError."""
    for (one, length), (other, second) in combinations(lengths.items(), 2):
        if abs(length - second) < apart:
            raise InputError(
                f"expected lengths at least {apart} frames apart, found {one} {length} and "
                f"{other} {second}; choose other frames"
            )


def chosen_length(spec: SetSpec, pairing: Pairing, library: Library, method: str) -> Length:
    """The blend length that a method chooses; loops are given room on both sides."""
    a, i = with_room(library.load(pairing.from_clip).motion, pairing.from_frame)
    b, j = with_room(library.load(pairing.to_clip).motion, pairing.to_frame)
    if method not in METHODS:
        raise InputError(f"expected methods among {', '.join(METHODS)}, found {method!r}.")
    route = way_of(spec, pairing, library, method)
    return blend_length(a, b, i, j, method, spec.specification, route)


def _faults(pairing: Pairing, library: Library) -> Iterator[str]:
    places = ((pairing.from_clip, pairing.from_frame), (pairing.to_clip, pairing.to_frame))
    motions = [library.load(clip).motion for clip, _ in places]
    for (clip, frame), motion in zip(places, motions, strict=True):
        last = len(motion) - 1
        if not 0 <= frame <= last:
            yield (
                f"expected a frame from 0 to {last} of {clip} (30 a second), "
                f"found {frame}; choose another"
            )
    try:
        check_pair(*motions)
    except InputError as error:
        told = str(error).replace("two motions: ", "")
        yield f"{pairing.from_clip} to {pairing.to_clip}: {told}"


def _lengths(spec: SetSpec, pairing: Pairing, reference: int) -> tuple[int, ...]:
    """The reference and the lengths around it, ascending."""
    differences = (0, *(-d for d in spec.shorter), *spec.longer)
    wanted = {reference + difference for difference in differences}
    missing = sorted(length for length in wanted if length < 1)
    if missing and not spec.drop_missing:
        raise InputError(
            f"expected blends of 1 frame or more, found {reference} - "
            f"{reference - missing[0]} = {missing[0]}.\n"
            "Leave that difference out of `shorter`, or set drop_missing."
        )
    if missing:
        dropped = ", ".join(str(length - reference) for length in missing)
        warnings.warn(
            f"{place_of(spec, pairing)}differences {dropped} from {reference} frames "
            "leave no blend and are dropped",
            InputWarning,
            stacklevel=4,
        )
    return tuple(sorted(wanted - set(missing)))
