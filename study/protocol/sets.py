"""From a protocol to its stimulus set: which clips, how joined, and the reference lengths."""

from typing import TYPE_CHECKING

from stimuli.errors import InputError
from study.protocol.protocol import Protocol

if TYPE_CHECKING:
    from stimuli.motion import Library
    from stimuli.sets import Manifest, SetSpec


def choose_set(protocol: Protocol, library: "Library", name: str | None = None) -> str:
    """The set called `name`, or the first whose clips are all found in the library."""
    _check_name(protocol, name)
    if name is not None:
        return name
    missing: dict[str, list[str]] = {}
    for candidate, table in protocol.file.sets.items():
        clips = sorted({role.clip for role in table.roles.values()})
        missing[candidate] = [clip for clip in clips if not library.candidates(clip)]
        if not missing[candidate]:
            return candidate
    lacking = "; ".join(f"{key} lacks {', '.join(clips)}" for key, clips in missing.items())
    places = ", ".join(map(str, library.directories)) or "no directory"
    raise InputError(
        f"{protocol.name}: expected the clips of one set in {places}, found none whole "
        f"({lacking}).\nFetch the sample motions with `segue motions fetch`, or name a directory "
        "with --motions DIR."
    )


def _check_name(protocol: Protocol, name: str | None) -> None:
    sets = protocol.file.sets
    if name is not None and name not in sets:
        raise InputError(
            f"{protocol.name}: expected one of the sets {', '.join(sets)}, found {name!r}"
        )


def set_spec(
    protocol: Protocol, set_name: str | None, library: "Library", rehearsal: bool = False
) -> "SetSpec":
    """What the stimulus builder needs to know of a protocol; a rehearsal has one short motion."""
    from stimuli.sets import Appearance, Pairing, SetSpec, Through

    file = protocol.file
    stimuli = file.stimuli
    chosen = file.sets[choose_set(protocol, library, set_name)]
    roles, collection = chosen.roles, chosen.collection
    pairings = tuple(
        Pairing(
            name=pair.name,
            from_clip=roles[pair.from_].clip,
            from_frame=roles[pair.from_].frame,
            to_clip=roles[pair.to].clip,
            to_frame=roles[pair.to].frame,
            category=pair.category,
        )
        for pair in stimuli.shown(rehearsal)
    )
    k = stimuli.reference if isinstance(stimuli.reference, int) else 0
    return SetSpec(
        name=protocol.name,
        pairings=pairings,
        specification=stimuli.specification,
        methods=file.methods,
        reference=stimuli.reference,
        shorter=tuple(sorted({*stimuli.shorter, *(k - n for n in stimuli.lengths if n < k)})),
        longer=tuple(sorted({*stimuli.longer, *(n - k for n in stimuli.lengths if n > k)})),
        drop_missing=stimuli.drop_missing,
        methods_apart=stimuli.methods_apart,
        seconds=file.rehearsal.seconds if rehearsal else stimuli.seconds,
        smooth=stimuli.smooth,
        foot_lock=stimuli.foot_lock,
        through=None if collection is None else Through(collection.clips, collection.tau),
        appearance=Appearance(**file.appearance.model_dump()),
        beside=file.beside,
    )


def references_of_manifest(protocol: Protocol, manifest: "Manifest") -> dict[str, int]:
    """The reference length of each motion as the stimulus set was built."""
    found = {name: entry.get("reference_length") for name, entry in manifest.pairings.items()}
    return {name: int(k) for name, k in found.items() if k is not None}


def references(
    protocol: Protocol, library: "Library | None", set_name: str | None = None
) -> dict[str, int]:
    """The reference lengths without a stimulus set: given, computed, or the observer's.

    A simulation needs no motions on disk: where `geodesic` cannot be computed the protocol's
    `observer.reference` stands in. Raises InputError when that is absent too, and for a set that
    the protocol does not have, whether or not its clips are needed.
    """
    _check_name(protocol, set_name)
    stimuli = protocol.file.stimuli
    names = [pair.name for pair in stimuli.motions]
    if stimuli.reference is None:
        return {}
    if isinstance(stimuli.reference, int):
        return dict.fromkeys(names, stimuli.reference)
    try:
        return _computed(protocol, library, set_name)
    except InputError:
        observer = protocol.file.observer
        if observer is None or observer.reference is None or set_name is not None:
            raise
        return dict.fromkeys(names, observer.reference)


def _computed(
    protocol: Protocol, library: "Library | None", set_name: str | None
) -> dict[str, int]:
    from stimuli.sets import resolve

    if library is None:
        raise InputError(f"{protocol.name}: expected motions to compute lengths, found none")
    resolved = resolve(set_spec(protocol, set_name, library), library)
    lengths = {pairing.name: pairing.reference_length for pairing in resolved}
    return {name: k for name, k in lengths.items() if k is not None}
