"""The joint that carries the body, made the root of its motion.

Some rigs put a root above the hips that stands still or walks on the floor below them: an armature,
the root motion of an engine. The hips then have position channels of their own. All that is above
them is folded into their position and rotation, which loses nothing.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.formats.source import Take
from stimuli.motion.roles import chain_to
from stimuli.motion.skeleton import children_of


def carrier(take: Take, roles: Mapping[str, int]) -> int:
    """The joint that carries the body: 0, the root, unless one below has positions of its own.

    That is the lowest from which legs, arms and head all hang; without legs, one that moves below
    a root that does not.
    """
    if not take.moves:
        return 0
    if "left_hip" not in roles or "right_hip" not in roles:
        return _moving_below(take)
    chains = [chain_to(take.parents, joint) for role, joint in roles.items() if role != "pelvis"]
    shared = [joint for joint in chains[0] if all(joint in chain for chain in chains)]
    return max((joint for joint in shared if joint in take.moves), default=0)


def _moving_below(take: Take) -> int:
    """The first joint that moves, of those before several hang on one, below a still root."""
    children, joint = children_of(take.parents), 0
    while True:
        places = take.moves.get(joint) if joint else take.root
        if places is not None and np.ptp(places, axis=0).max() > 0:
            return joint
        if np.ptp(take.rotations[:, joint], axis=0).max() > 0 or len(children[joint]) != 1:
            return 0
        joint = children[joint][0]


def folded(take: Take, joint: int) -> tuple[Take, str]:
    """The motion with a joint as its root, and a note of what became of the others."""
    above = chain_to(take.parents, joint)
    turn, place = take.rotations[:, 0], take.root
    for link in above[1:]:
        place = place + quat.rotate(turn, take.moves.get(link, take.offsets[link]))
        turn = quat.multiply(turn, take.rotations[:, link])
    kept = [k for k in range(len(take.names)) if joint in chain_to(take.parents, k)]
    index = {old: new for new, old in enumerate(kept)}
    ends = [k for k, parent in enumerate(take.end_parents.tolist()) if parent in index]
    rotations = take.rotations[:, kept]
    rotations[:, 0] = turn
    still = np.all(take.rotations[:, above, 1:] == 0, axis=(1, 2))
    names = ", ".join(take.names[link] for link in above[:-1])
    offsets = take.offsets[kept]
    offsets[0] = 0.0
    if take.declared is not None and np.all(place == take.moves.get(joint)):
        offsets[0] = take.declared[joint]  # to which its positions may be relative, as a root's
    note = f"{take.names[joint]} carries the body: {names} above it folded in"
    if lost := [take.names[k] for k in range(len(take.names)) if k not in {*kept, *above}]:
        note += f"; left out: {', '.join(lost[:6])}{' …' if len(lost) > 6 else ''}"
    return replace(
        take,
        names=tuple(take.names[k] for k in kept),
        parents=np.array([-1, *(index[int(take.parents[k])] for k in kept[1:])]),
        offsets=offsets,
        end_parents=np.array([index[int(take.end_parents[k])] for k in ends], dtype=int),
        end_offsets=take.end_offsets[ends],
        rotations=rotations,
        root=place,
        moves={index[k]: track for k, track in take.moves.items() if k in index and k != joint},
        declared=None,
        at_rest=None if take.at_rest is None else still,
    ), note
