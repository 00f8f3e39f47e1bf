"""Room for a blend around a frame of a loop, which has no ends."""

from stimuli.motion.loops import unroll
from stimuli.motion.skeleton import Motion
from stimuli.transition.window import LONGEST


def with_room(motion: Motion, frame: int, frames: int = LONGEST) -> tuple[Motion, int]:
    """A loop unrolled so that `frames` frames lie on both sides of `frame`; its new number.

    A motion that is no loop comes back as it is.
    """
    before, after = frames - frame, frames - (len(motion) - 1 - frame)
    longer, shift = unroll(motion, before, after)
    return longer, frame + shift
