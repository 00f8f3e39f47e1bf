"""Cost against blend length, for all joints together (Fig. V.2) and for each alone (Fig. V.6)."""

from collections.abc import Mapping

from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.transition.length import geodesic_costs
from stimuli.transition.weights import Weights, named_weights


def joint_curves(
    a: Motion,
    b: Motion,
    i: int,
    j: int,
    specification: str,
    weights: str | Weights = "wang",
) -> Mapping[str, Array]:
    """For every weighted role, its own mean θ² over the frames mixed for b = 1 … 60."""
    roles = [role for role, weight in named_weights(weights).items() if weight > 0]
    return {role: geodesic_costs(a, b, i, j, specification, {role: 1.0}) for role in roles}
