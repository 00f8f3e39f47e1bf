"""The joint that carries the body, made the root of its motion.

Some rigs put a root above the hips that stands still or walks on the floor below them: an armature,
the root motion of an engine. The hips then have position channels of their own. All that is above
them is folded into their position and rotation, which loses nothing.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.formats.source import Source
from stimuli.motion.roles import chain_to
from stimuli.motion.skeleton import children_of


def carrier(source: Source, roles: Mapping[str, int]) -> int:
    """The lowest joint with position channels from which the whole body still hangs."""
    chains = [chain_to(source.parents, joint) for role, joint in roles.items() if role != "pelvis"]
    if len(chains) > 1:
        shared = [joint for joint in chains[0] if all(joint in chain for chain in chains)]
    else:
        shared = _trunk(source.parents)
    return max((joint for joint in shared if joint in source.moves), default=0)


def _trunk(parents: np.ndarray) -> list[int]:
    """The joints down to the first on which several hang."""
    children, trunk = children_of(parents), [0]
    while len(children[trunk[-1]]) == 1:
        trunk += children[trunk[-1]]
    return trunk


def folded(source: Source, joint: int) -> tuple[Source, str]:
    """The motion with a joint as its root, and a note of what became of the others."""
    above = chain_to(source.parents, joint)
    turn, place = source.rotations[:, 0], source.root
    for link in above[1:]:
        place = place + quat.rotate(turn, source.moves.get(link, source.offsets[link]))
        turn = quat.multiply(turn, source.rotations[:, link])
    kept = [k for k in range(len(source.names)) if joint in chain_to(source.parents, k)]
    index = {old: new for new, old in enumerate(kept)}
    ends = [k for k, parent in enumerate(source.end_parents.tolist()) if parent in index]
    rotations = source.rotations[:, kept]
    rotations[:, 0] = turn
    still = np.all(source.rotations[:, above, 1:] == 0, axis=(1, 2))
    names = ", ".join(source.names[link] for link in above[:-1])
    note = f"{source.names[joint]} carries the body: {names} above it folded in"
    if lost := [source.names[k] for k in range(len(source.names)) if k not in {*kept, *above}]:
        note += f"; left out: {', '.join(lost[:6])}{' …' if len(lost) > 6 else ''}"
    return replace(
        source,
        names=tuple(source.names[k] for k in kept),
        parents=np.array([-1, *(index[int(source.parents[k])] for k in kept[1:])]),
        offsets=np.concatenate([np.zeros((1, 3)), source.offsets[kept[1:]]]),
        end_parents=np.array([index[int(source.end_parents[k])] for k in ends], dtype=int),
        end_offsets=source.end_offsets[ends],
        rotations=rotations,
        root=place,
        moves={index[k]: track for k, track in source.moves.items() if k in index and k != joint},
        at_rest=None if source.at_rest is None else still,
    ), note
