"""What a transition is like to look at: measures against which thresholds can be fitted.

Joints are points in the world, positions in metres, rates a frame at 30 a second.
"""

import numpy as np

from stimuli.errors import InputError
from stimuli.motion.kinematics import forward
from stimuli.motion.quaternions import Array
from stimuli.transition.length import geodesic_costs
from stimuli.transition.methods import Transition
from stimuli.transition.plants import contacts, leg_pose
from stimuli.transition.window import LONGEST

MEASURES = (
    "velocity_jump",
    "acceleration_jump",
    "foot_slide",
    "geodesic_cost",
    "displacement_from_reference",
)


def transition_measures(
    transition: Transition, reference: Transition | None = None
) -> dict[str, float | None]:
    """Measures of a transition; None for what cannot be told.

    - velocity_jump, acceleration_jump: the largest change of any joint's velocity (metres a
      frame) and acceleration (a frame²) from one frame to the next at the blend's two ends;
    - foot_slide: metres that standing feet travel on the floor, a frame, on average over the
      frames mixed; 0 where no foot stands;
    - geodesic_cost: the mean weighted distance over the frames mixed (V.1);
    - displacement_from_reference: mean distance (metres) of a joint from where it is in the
      reference transition at the same frame, over the frames that either mixes.
    """
    motion = transition.motion
    positions, _ = forward(motion.skeleton, motion.rotations, motion.root)
    velocity, acceleration = _jumps(positions, transition.mixed)
    return {
        "velocity_jump": velocity,
        "acceleration_jump": acceleration,
        "foot_slide": _foot_slide(transition),
        "geodesic_cost": _cost(transition),
        "displacement_from_reference": _displacement(transition, positions, reference),
    }


def _jumps(positions: Array, mixed: tuple[int, int]) -> tuple[float, float]:
    """Largest second and third differences of a joint across either end of the blend."""
    largest = [0.0, 0.0]
    for order in (2, 3):
        differences = np.linalg.norm(np.diff(positions, order, axis=0), axis=-1).max(axis=1)
        for last_pure, first_mixed in ((mixed[0] - 1, mixed[0]), (mixed[1], mixed[1] + 1)):
            around = differences[max(last_pure - order + 1, 0) : first_mixed]
            if len(around):
                largest[order - 2] = max(largest[order - 2], float(around.max()))
    return largest[0], largest[1]


def _foot_slide(transition: Transition) -> float | None:
    """Mean travel a frame of the standing part of standing feet, over the frames mixed."""
    motion, (first, last) = transition.motion, transition.mixed
    played = transition.played
    if played is None:
        return None
    try:
        a, b = contacts(played[0]), contacts(played[1])
    except InputError:  # no legs are known
        return None
    rows = slice(max(first - 1, 0), min(last + 2, len(motion)))
    frames = np.arange(rows.start, rows.stop)
    later = frames > (first + last) / 2
    here = np.clip(frames, 0, len(a.stands) - 1)
    there = np.clip(frames + len(played[1]) - len(motion), 0, len(b.stands) - 1)
    stands = np.where(later[:, None], b.stands[there], a.stands[here])
    on_toe = np.where(later[:, None], b.on_toe[there], a.on_toe[here])[1:, :, None]
    pose = leg_pose(motion, rows)
    steps = on_toe * np.diff(pose.toe, axis=0) + (1 - on_toe) * np.diff(pose.ankle, axis=0)
    both = stands[1:] & stands[:-1]
    travel = np.linalg.norm(steps[both][:, [0, 2]], axis=1)
    return float(travel.mean()) if len(travel) else 0.0


def _cost(transition: Transition) -> float | None:
    """The mean distance of the frames mixed, as warped; of the two frames at a cut."""
    if transition.method == "timewarp":
        return float(transition.report["cost"])
    if transition.sources is None:
        return None
    a, b = transition.sources
    if transition.frames > LONGEST:
        return None
    frames = max(transition.frames, 1)
    specification = transition.specification if transition.frames else "center-aligned"
    cost = geodesic_costs(a, b, transition.i, transition.j, specification)[frames - 1]
    return None if np.isnan(cost) else float(cost)


def _displacement(
    transition: Transition, positions: Array, reference: Transition | None
) -> float | None:
    """Mean joint distance from the reference over the frames that either of the two mixes."""
    if reference is None:
        return None
    other = reference.motion
    there, _ = forward(other.skeleton, other.rotations, other.root)
    first = min(transition.mixed[0], reference.mixed[0])
    last = max(transition.mixed[1], reference.mixed[1]) + 1
    rows = slice(first, min(last, len(positions), len(there)))
    return float(np.linalg.norm(positions[rows] - there[rows], axis=-1).mean())
