"""Reading the clips of DeepMimic: JSON, the poses of one humanoid of 15 joints.

A frame is its duration, the root's position and quaternion, then for each joint in order four
numbers of a quaternion (w, x, y, z), or one angle about Z for the hinges, or none for the wrists.
The humanoid's offsets are those of its model (Peng et al. 2018, `humanoid.urdf` of Bullet at a
quarter of its scale), in metres; it faces +X in rest. A clip with "Loop": "wrap" is one cycle:
its last frame is the first of the next.
"""

import json
from pathlib import Path

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.formats.rates import rate, rounded_rate
from stimuli.motion.formats.source import (
    Take,
    check_size,
    depth_first,
    fault,
    shown,
    text_of,
)
from stimuli.motion.formats.words import IN_BOUNDS, LARGEST_NUMBER
from stimuli.motion.quaternions import Array
from stimuli.motion.resample import sampled

_HUMANOID = (  # name, parent, numbers in a frame, offset in metres
    ("root", -1, 4, (0.0, 0.0, 0.0)),
    ("chest", 0, 4, (0.0, 0.236151, 0.0)),
    ("neck", 1, 4, (0.0, 0.223894, 0.0)),
    ("right_hip", 0, 4, (0.0, 0.0, 0.084887)),
    ("right_knee", 3, 1, (0.0, -0.421546, 0.0)),
    ("right_ankle", 4, 4, (0.0, -0.409870, 0.0)),
    ("right_shoulder", 1, 4, (-0.02405, 0.2435, 0.18311)),
    ("right_elbow", 6, 1, (0.0, -0.274788, 0.0)),
    ("right_wrist", 7, 0, (0.0, -0.258947, 0.0)),
    ("left_hip", 0, 4, (0.0, 0.0, -0.084887)),
    ("left_knee", 9, 1, (0.0, -0.421546, 0.0)),
    ("left_ankle", 10, 4, (0.0, -0.409870, 0.0)),
    ("left_shoulder", 1, 4, (-0.02405, 0.2435, -0.18311)),
    ("left_elbow", 12, 1, (0.0, -0.274788, 0.0)),
    ("left_wrist", 13, 0, (0.0, -0.258947, 0.0)),
)
# head top, and on either side toes (the foot box's front edge, at the sole) and fingertips
_ENDS = (
    (2, (0.0, 0.2775, 0.0)),
    (5, (0.1335, -0.05, 0.0)),
    (8, (0.0, -0.08, 0.0)),
    (11, (0.1335, -0.05, 0.0)),
    (14, (0.0, -0.08, 0.0)),
)
JOINT_NAMES = tuple(name for name, *_ in _HUMANOID)
PARENTS = np.array([parent for _, parent, *_ in _HUMANOID])
OFFSETS = np.array([offset for *_, offset in _HUMANOID])
END_PARENTS = np.array([parent for parent, _ in _ENDS])
END_OFFSETS = np.array([offset for _, offset in _ENDS])
_WIDTH = 4 + sum(width for _, _, width, _ in _HUMANOID)
_TODO = "Take the clip from its source again; only clips of the humanoid can be read."


def read_deepmimic(path: Path, data: bytes, fps: float | None = None) -> Take:
    """The motion of a DeepMimic clip; `fps` overrides its frame durations."""
    table, loop = _table(path, text_of(path, data))
    rotations = np.tile(quat.IDENTITY, (len(table), len(JOINT_NAMES), 1))
    column = 4
    for joint, (_, _, width, _) in enumerate(_HUMANOID):
        values = table[:, column : column + width]
        if width == 4:
            rotations[:, joint] = values
        elif width == 1:
            rotations[:, joint] = quat.about("Z", values[:, 0])
        column += width
    norms = np.linalg.norm(rotations, axis=-1)
    if not np.all((norms > 0.5) & (norms < 2.0)):
        frame = int(np.argwhere((norms <= 0.5) | (norms >= 2.0))[0, 0])
        raise fault(path, "unit quaternions", f"another length in frame {frame + 1}", _TODO)
    rotations = quat.normalise(rotations)
    root = table[:, 1:4]
    rotations, root, own_rate = _even(path, table[:, 0], rotations, root)
    take = Take(
        format="deepmimic",
        names=JOINT_NAMES,
        parents=PARENTS,
        offsets=OFFSETS,
        end_parents=END_PARENTS,
        end_offsets=END_OFFSETS,
        rotations=rotations,
        root=root,
        fps=fps if fps is not None else own_rate,
        loop=loop,
    )
    return depth_first(take)


def _table(path: Path, text: str) -> tuple[Array, bool]:
    """The frames (F, 44), and whether the clip is a loop."""
    try:
        document = json.loads(text, parse_int=float)  # int() raises at thousands of digits
    except (ValueError, RecursionError) as error:
        raise fault(path, "JSON", shown(str(error), 80), _TODO) from None
    frames = document.get("Frames") if isinstance(document, dict) else None
    if not isinstance(frames, list) or not frames:
        raise fault(path, 'a list "Frames"', "none", _TODO)
    widths = {len(frame) if isinstance(frame, list) else 0 for frame in frames}
    if widths != {_WIDTH}:
        odd = min(widths - {_WIDTH})
        raise fault(
            path,
            f"frames of {_WIDTH} numbers (the humanoid's)",
            f"{odd}: another character",
            _TODO,
        )
    kinds = {type(value) for frame in frames for value in frame}
    if odd_kinds := sorted(kind.__name__ for kind in kinds - {float}):
        raise fault(path, "numbers in every frame", ", ".join(odd_kinds), _TODO)
    table = np.array(frames)
    if not np.all(np.abs(table) < LARGEST_NUMBER):
        raise fault(path, f"numbers {IN_BOUNDS}", "infinite or huge ones", _TODO)
    return table, document.get("Loop") == "wrap"


def _even(
    path: Path, durations: Array, rotations: Array, root: Array
) -> tuple[Array, Array, float]:
    """Poses at an even rate: as they are, or sampled at the median duration when those vary."""
    if len(durations) == 1:
        return rotations, root, 30.0
    steps = durations[:-1]
    for step in (steps.min(), steps.max()):
        rate(path, float(step))
    typical = float(np.median(steps))
    times = np.concatenate([[0.0], np.cumsum(steps)])
    is_even = np.allclose(steps, typical, rtol=1e-3)
    count = len(times) if is_even else int(times[-1] / typical + 1e-6) + 1
    check_size(path, count, len(JOINT_NAMES), 1.0 / typical)
    if not is_even:
        places = np.interp(np.arange(count) * typical, times, np.arange(len(times)))
        rotations, root = sampled(rotations, root, places)
    return rotations, root, rounded_rate(1.0 / typical)
