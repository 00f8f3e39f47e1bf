"""Loops of one cycle, unrolled into as many cycles as a clip needs.

The last frame of a loop is the first of the next cycle, but captured ends never meet exactly. The
mismatch of pose and of velocity at the seam is halved between both sides and fades over a third
of a second by cubic Hermite polynomials, so that positions and velocities are continuous there.
What remains of the root's displacement and heading after a cycle accumulates.
"""

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import heading
from stimuli.motion.quaternions import Array
from stimuli.motion.resample import sampled
from stimuli.motion.skeleton import Cycle, Motion

FADE = 1 / 3  # seconds on either side of the seam, at most a third of the cycle


def unroll(motion: Motion, frames_before: int, frames_after: int) -> tuple[Motion, int]:
    """Whole cycles of a loop added, so that `frames_before` frames exist before frame 0 and
    `frames_after` after the last one.

    Returns the motion and the index of the old frame 0 in it. A motion that is no loop, or needs
    no more frames, comes back as it is.
    """
    cycle = motion.cycle
    if cycle is None or (frames_before <= 0 and frames_after <= 0):
        return motion, 0
    before, after = (
        int(np.ceil(max(frames, 0) / cycle.period - 1e-9))
        for frames in (frames_before, frames_after)
    )
    shift = int(np.floor(before * cycle.period + 1e-9))
    last = len(motion) - 1 + int(np.floor(after * cycle.period + 1e-9))
    times = np.arange(-shift, last + 1)
    turns = np.floor(times / cycle.period + 1e-9).astype(int)
    steps = len(cycle.root) - 1
    places = (times - turns * cycle.period) * (steps / cycle.period)
    rotations, root = sampled(cycle.rotations, cycle.root, np.clip(places, 0.0, steps))
    rotations, root = _carried(rotations, root, turns, cycle)
    return Motion(motion.skeleton, quat.continuous(rotations), root, motion.fps), shift


def closed_cycle(motion: Motion, rate: float) -> Cycle:
    """The cycle of a motion whose last frame is the first of the next; period in frames at `rate`.

    The next cycle starts with the heading and on the floor position of this one's last frame.
    """
    ends = motion.rotations[[0, -1]]
    first, last = heading(motion.skeleton, ends, motion.root[[0, -1]])
    yaw = float((last - first + np.pi) % (2 * np.pi) - np.pi)
    shift = motion.root[-1] - quat.rotate(quat.about("Y", yaw), motion.root[0])
    shift[1] = 0.0
    period = (len(motion) - 1) * rate / motion.fps
    open_cycle = Cycle(period, yaw, shift, motion.rotations, motion.root)
    rotations, root = _closed(open_cycle, motion.fps)
    return Cycle(period, yaw, shift, rotations, root)


def _carried(rotations: Array, root: Array, turns: np.ndarray, cycle: Cycle) -> tuple[Array, Array]:
    """Poses (N, J, 4) and (N, 3) moved on by `turns` (N,) cycles, which may be negative."""
    shifts = {0: np.zeros(3)}
    for turn in range(1, int(turns.max()) + 1):
        shifts[turn] = quat.rotate(quat.about("Y", cycle.yaw), shifts[turn - 1]) + cycle.shift
    for turn in range(-1, int(turns.min()) - 1, -1):
        shifts[turn] = quat.rotate(quat.about("Y", -cycle.yaw), shifts[turn + 1] - cycle.shift)
    turned = quat.about("Y", turns * cycle.yaw)
    rotations = rotations.copy()
    rotations[:, 0] = quat.multiply(turned, rotations[:, 0])
    return rotations, quat.rotate(turned, root) + np.array([shifts[int(t)] for t in turns])


def _closed(cycle: Cycle, fps: float) -> tuple[Array, Array]:
    """The poses of a cycle with its seam closed: half of every mismatch faded in on each side."""
    steps = len(cycle.root) - 1
    near = max(
        1, round(fps / 30.0)
    )  # velocities at the seam are taken over a thirtieth of a second
    near = min(near, steps - 1)
    next_rotations, next_root = _carried(
        cycle.rotations[: near + 1], cycle.root[: near + 1], np.ones(near + 1, dtype=int), cycle
    )
    end, before = cycle.rotations[-1], cycle.rotations[-1 - near]
    jump = quat.log(quat.shorter(quat.multiply(quat.inverse(end), next_rotations[0])))
    speeds = [
        quat.log(quat.shorter(quat.multiply(quat.inverse(p), q))) / near
        for p, q in ((before, end), (next_rotations[0], next_rotations[near]))
    ]
    rise = next_root[0] - cycle.root[-1]
    root_speeds = [
        (cycle.root[-1] - cycle.root[-1 - near]) / near,
        (next_root[near] - next_root[0]) / near,
    ]
    width = max(1, min(round(FADE * fps), steps // 3))
    tail = _fade(width, 0.5 * jump, 0.5 * (speeds[1] - speeds[0]))[::-1]
    head = _fade(width, -0.5 * jump, 0.5 * (speeds[1] - speeds[0]))
    rotations, root = cycle.rotations.copy(), cycle.root.copy()
    rotations[-width - 1 :] = quat.multiply(rotations[-width - 1 :], quat.exp(tail))
    rotations[: width + 1] = quat.multiply(rotations[: width + 1], quat.exp(head))
    kink = 0.5 * (root_speeds[1] - root_speeds[0])
    home = quat.about("Y", -cycle.yaw)  # the head is edited in the first cycle's own heading
    root[-width - 1 :] += _fade(width, 0.5 * rise, kink)[::-1]
    root[: width + 1] += quat.rotate(home, _fade(width, -0.5 * rise, kink))
    return rotations, root


def _fade(width: int, value: Array, slope: Array) -> Array:
    """Offsets (width + 1, ...) falling from `value` to 0 with a change of speed at the seam.

    A cubic Hermite in the distance from the seam: it starts at `value`, moves against `slope` (a
    frame, away from the seam on either side alike) and ends flat at 0.
    """
    s = np.arange(width + 1) / width
    s = s.reshape(-1, *([1] * value.ndim))
    return (1 - s) ** 2 * (1 + 2 * s) * value - s * (1 - s) ** 2 * width * slope
