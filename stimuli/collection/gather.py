"""Clips of one hierarchy as one collection: on one body, each clip by a name of its own."""

import hashlib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from stimuli.collection.annotations import Span, annotated
from stimuli.errors import InputError
from stimuli.motion.clip import Clip
from stimuli.motion.loops import unroll
from stimuli.motion.skeleton import Motion, Skeleton
from stimuli.transition.align import on_skeleton

CYCLES = 2  # that a loop is played on for, so that it can be left where it was entered
LEAST = 4  # frames of a clip: fewer have no rates of change
NEEDED = ("left_hip", "right_hip")  # roles without which a pose has no heading


@dataclass(frozen=True, eq=False)
class Collection:
    """Clips on one body. Frame n of a clip is frame n of its file at the working rate.

    A loop is played on for two more cycles. `spans` are what is done in which frames of a clip.
    """

    names: tuple[str, ...]
    motions: tuple[Motion, ...]
    spans: tuple[tuple[Span, ...], ...]
    remarks: tuple[str, ...] = field(default=())

    def __len__(self) -> int:
        return len(self.names)

    @property
    def skeleton(self) -> Skeleton:
        """The body of the first clip, on which all are."""
        return self.motions[0].skeleton

    @cached_property
    def starts(self) -> np.ndarray:
        """Where each clip's frames begin when all lie in a row (N + 1,); the last is their sum."""
        return np.concatenate([[0], np.cumsum([len(motion) for motion in self.motions])])

    @cached_property
    def hash(self) -> str:
        """SHA-256 of the frames of all clips, and of what is done in them."""
        sha = hashlib.sha256()
        body = self.skeleton
        sha.update(repr((self.names, self.spans, body.names, sorted(body.roles.items()))).encode())
        for motion in self.motions:
            for part in (body.offsets, motion.rotations, motion.root):
                sha.update(np.ascontiguousarray(part, dtype="<f8").tobytes())
        return sha.hexdigest()

    def place(self, name: str) -> int:
        """Which clip is called so; InputError when none is."""
        if name not in self.names:
            raise InputError(
                f"{name}: expected a clip of the collection, found none of that name.\n"
                f"It has {', '.join(self.names[:6])}{' …' if len(self) > 6 else ''}."
            )
        return self.names.index(name)


def gathered(clips: Sequence[Clip], annotations: Mapping[str, Sequence[Span]] | None = None) -> (
    Collection
):  # fmt: skip
    """The clips as one collection, all faults at once.

    `annotations` are spans by clip; without them those of `annotations.csv` beside a clip, else the
    words of its name. InputError for no clip, clips of different hierarchies, clips without hips or
    legs, and clips of so few frames that nothing moves.
    """
    if not clips:
        raise InputError(
            "collection: expected motion clips, found none.\nName their directory with --motions."
        )
    if faults := _faults(clips):
        raise InputError("\n".join(faults))
    body = clips[0].motion.skeleton
    motions = tuple(_played(on_skeleton(clip.motion, body), clip.motion) for clip in clips)
    names = _told_apart(clips)
    spans = tuple(
        tuple(annotations[name])
        if annotations is not None and name in annotations
        else annotated(clip, len(motion))
        for name, clip, motion in zip(names, clips, motions, strict=True)
    )
    return Collection(names, motions, spans, _remarks(clips))


def _played(motion: Motion, source: Motion) -> Motion:
    """A loop for two cycles more, another motion as it is."""
    if source.cycle is None:
        return motion
    period = source.cycle.period
    looped = Motion(motion.skeleton, motion.rotations, motion.root, motion.fps, source.cycle)
    longer, _ = unroll(looped, 0, int(CYCLES * period) - 1)
    return longer


def _faults(clips: Sequence[Clip]) -> list[str]:
    first = clips[0]
    others = [c for c in clips if not c.motion.skeleton.same_hierarchy(first.motion.skeleton)]
    found = []
    if others:
        named = ", ".join(clip.name for clip in others[:4])
        more = f" and {len(others) - 4} more" if len(others) > 4 else ""
        found.append(
            f"collection: expected clips of one hierarchy, that of {first.name} "
            f"({first.joints} joints), found others: {named}{more}; "
            "give each performer's and exporter's clips a directory of their own (--motions)."
        )
    lacking = [role for role in NEEDED if role not in first.motion.skeleton.roles]
    if lacking:
        found.append(
            f"collection: no joint of {first.name} plays {', '.join(lacking)}, without which no "
            "pose has a heading; name them in overrides.toml beside the clips "
            "(`segue motions --roles FILE` prints one)."
        )
    short = [clip.name for clip in clips if len(clip.motion) < LEAST]
    if short:
        found.append(
            f"collection: expected clips of {LEAST} frames or more, found fewer in "
            f"{', '.join(short)}; leave them out."
        )
    return found


def _told_apart(clips: Sequence[Clip]) -> tuple[str, ...]:
    """Names of clips; where two have one, with as many folders before it as tell them apart."""
    often = Counter(clip.name for clip in clips)
    names = []
    for clip in clips:
        parts = clip.path.with_suffix("").parts
        twins = [c.path.with_suffix("").parts for c in clips if c.name == clip.name]
        depth = 1
        while often[clip.name] > 1 and depth < len(parts):
            depth += 1
            if sum(twin[-depth:] == parts[-depth:] for twin in twins) == 1:
                break
        names.append("/".join(parts[-depth:]) if depth > 1 else clip.name)
    return tuple(names)


def _remarks(clips: Sequence[Clip]) -> tuple[str, ...]:
    if len(clips) > 1:
        return ()
    return (
        f"the collection is one clip, {clips[0].name}: it can only be cut to itself; "
        "name a directory of clips of the same performer with --motions",
    )
