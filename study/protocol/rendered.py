"""Whether a stimulus set was rendered from what the protocol says now, told in words.

The manifest alone is compared, so no motion needs to be on the disk; what a manifest does not hold
is not compared.
"""

import shlex
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stimuli.errors import InputError
from study.protocol.protocol import Protocol
from study.protocol.schema import MotionPair, Role

if TYPE_CHECKING:
    from stimuli.sets import Manifest

MOST_TOLD = 3
SETS = Path("stimulus-sets")


def check_rendered(protocol: Protocol, manifest: "Manifest", rehearsal: bool = False) -> None:
    """Refuse a set of another protocol, and one rendered before the protocol was edited."""
    pairs = protocol.file.stimuli.shown(rehearsal)
    absent = [pair.name for pair in pairs if pair.name not in manifest.pairings]
    told, chosen = _nearest(protocol, pairs, manifest, rehearsal) if not absent else ([], None)
    if manifest.name != protocol.name and (absent or told):
        raise InputError(
            f"{manifest.directory}: expected the stimulus set of {protocol.name}, found that of "
            f"{manifest.name};\nname the right one with --stimuli, or run "
            f"`{render_command(protocol)}` and leave --stimuli out"
        )
    told = [f"holds no motion {name} of the protocol" for name in absent] or told
    if told:
        more = f"; and {len(told) - MOST_TOLD} more" if len(told) > MOST_TOLD else ""
        raise InputError(
            f"{manifest.directory}: {'; '.join(told[:MOST_TOLD])}{more};\n"
            f"{_remedy(protocol, manifest, chosen, rehearsal)}"
        )


def render_command(protocol: Protocol, *options: str) -> str:
    """The command that renders a protocol's set, as it can be typed."""
    return shlex.join(["segue", "render", protocol.called, *options])


def again_command(protocol: Protocol, directory: Path, set_name: str | None = None) -> str:
    """The command that renders a protocol's set into the directory where it lies."""
    out = () if directory == SETS / protocol.name else ("--out", str(directory))
    first = next(iter(protocol.file.sets))
    named = () if set_name in (None, first) else ("--set", str(set_name))
    return render_command(protocol, *named, *out)


def _remedy(protocol: Protocol, manifest: "Manifest", chosen: str | None, rehearsal: bool) -> str:
    if rehearsal:
        return "leave --stimuli out: a rehearsal builds its own set"
    return f"run `{again_command(protocol, manifest.directory, chosen)}` again"


def _nearest(
    protocol: Protocol, pairs: tuple[MotionPair, ...], manifest: "Manifest", rehearsal: bool
) -> tuple[list[str], str]:
    """What differs from the set of clips that differs least, and that set's name.

    The manifest does not say which set it was rendered from.
    """
    common = [
        *_layout(protocol, pairs, manifest, rehearsal),
        *_looks(protocol, pairs, manifest),
    ]
    found = [
        (list(_sources(pairs, table.roles, manifest)), name)
        for name, table in protocol.file.sets.items()
    ]
    told, name = min(found, key=lambda entry: len(entry[0]))
    return [*told, *common], name


def _sources(
    pairs: tuple[MotionPair, ...], roles: Mapping[str, Role], manifest: "Manifest"
) -> Iterator[str]:
    for pair in pairs:
        for side, role in (("from", roles[pair.from_]), ("to", roles[pair.to])):
            held = manifest.pairings[pair.name].get(side)
            if held is not None and (held["clip"], held["frame"]) != (role.clip, role.frame):
                yield _differs(
                    f"{pair.name}: rendered {side} {held['clip']}:{held['frame']}",
                    f"{role.clip}:{role.frame}",
                )


def _layout(
    protocol: Protocol, pairs: tuple[MotionPair, ...], manifest: "Manifest", rehearsal: bool
) -> Iterator[str]:
    """The specification, the seconds, and the lengths or methods of every motion."""
    file = protocol.file
    stimuli = file.stimuli
    if manifest.specification != stimuli.specification:
        yield _differs(f"rendered {manifest.specification}", stimuli.specification)
    # A rehearsal may be shown clips of full length, if somebody names their set.
    fitting = [*([file.rehearsal.seconds] if rehearsal else []), stimuli.seconds]
    if manifest.seconds not in fitting:
        yield _differs(f"rendered as clips of {manifest.seconds:g} s", f"{fitting[0]:g} s")
    for pair in pairs:
        held = manifest.pairings[pair.name]
        if stimuli.reference is None:
            if "methods" in held and tuple(held["methods"]) != file.methods:
                yield _differs(
                    f"{pair.name}: rendered by {', '.join(held['methods']) or 'no method'}",
                    ", ".join(file.methods),
                )
        else:
            yield from _lengths(protocol, pair.name, held)


def _lengths(protocol: Protocol, name: str, held: Mapping[str, Any]) -> Iterator[str]:
    """A computed reference is the manifest's own: it cannot be computed without the motions."""
    stimuli, k = protocol.file.stimuli, held.get("reference_length")
    if k is None or (isinstance(stimuli.reference, int) and k != stimuli.reference):
        found = "no reference length" if k is None else f"reference length {k}"
        yield _differs(f"{name}: rendered with {found}", str(stimuli.reference))
        return
    wanted = {k, *(k - d for d in stimuli.shorter), *(k + d for d in stimuli.longer)}
    lengths = sorted(n for n in {*wanted, *stimuli.lengths} if n >= 1)
    if "lengths" in held and sorted(held["lengths"]) != lengths:
        yield _differs(f"{name}: rendered with lengths {_listed(held['lengths'])}",
                       _listed(lengths))  # fmt: skip


def _looks(
    protocol: Protocol, pairs: tuple[MotionPair, ...], manifest: "Manifest"
) -> Iterator[str]:
    """What every clip's entry says of how it was made and looks; each difference once."""
    stimuli = protocol.file.stimuli
    said = {"smooth": stimuli.smooth, "foot_lock": stimuli.foot_lock}
    look = protocol.file.appearance.model_dump(mode="json")
    names = {pair.name for pair in pairs}
    told: dict[str, None] = {}
    for clip in manifest.clips:
        if clip.motion not in names:
            continue
        held = clip.document
        looked = held.get("appearance", {})
        for key, now, then in (
            *((key, value, held[key]) for key, value in said.items() if key in held),
            *((key, value, looked[key]) for key, value in look.items() if key in looked),
        ):
            if then != now:
                told[_differs(f"rendered with {key} {_plain(then)}", _plain(now))] = None
    yield from told


def _differs(rendered: str, said: str) -> str:
    return f"{rendered}, the protocol says {said}"


def _listed(numbers: Any) -> str:
    return ", ".join(map(str, numbers))


def _plain(value: Any) -> str:
    """A value as the protocol's file has it."""
    return str(value).lower() if isinstance(value, bool) else str(value)
