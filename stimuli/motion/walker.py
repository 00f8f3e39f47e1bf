"""A generated walker, for when no captured motion can be had: labelled so, and merely plausible.

Feet come first: each rolls from heel to toe on the floor, then swings; the legs follow by two-bone
inverse kinematics, so that a standing foot does not slide. Pelvis, chest and arms move by sines in
the phases of textbook gait. The body is DeepMimic's humanoid, walking along +X.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stimuli.files import write_atomic
from stimuli.motion import quaternions as quat
from stimuli.motion.clip import load_clip
from stimuli.motion.formats.deepmimic import JOINT_NAMES, OFFSETS
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion

CLIP_NAME = "generated-walker"
_FPS = 30
_THIGH, _SHANK = (
    float(-OFFSETS[JOINT_NAMES.index(name), 1]) for name in ("left_knee", "left_ankle")
)
_HEEL, _TOE, _SOLE = -0.0435, 0.1335, -0.05  # of the foot box, from the ankle
_STANCE = 0.62  # share of a foot's cycle on the floor
_PITCH = (  # (phase, degrees toe up): heel strike, flat, heel off, toe off, swing
    (0.0, 18.0), (0.12, 0.0), (0.36, 0.0), (0.62, -38.0), (0.74, -30.0), (0.92, 16.0), (1.0, 18.0),
)  # fmt: skip


@dataclass(frozen=True)
class _Gait:
    """What a seed decides: frames of a cycle, metres of a stride, swing of arms and trunk."""

    frames: int
    stride: float
    arm: float
    trunk: float


def walker(seed: int = 0) -> Motion:
    """One cycle of the generated walker; the seed varies cadence, stride and swing."""
    from tempfile import TemporaryDirectory

    with TemporaryDirectory(prefix="segue-") as directory:
        return load_clip(write_walker(Path(directory), seed)).motion


def write_walker(directory: Path, seed: int = 0) -> Path:
    """Write the generated walker of a seed as `generated-walker-SEED.json`; returns its path."""
    document = {
        "Loop": "wrap",
        "Note": f"generated, not captured: Segue's walker of seed {seed}",
        "Frames": [[round(float(value), 9) for value in row] for row in _table(_gait(seed))],
    }
    path = Path(directory) / f"{CLIP_NAME}-{seed}.json"
    write_atomic(path, json.dumps(document))
    return path


def _gait(seed: int) -> _Gait:
    generator = np.random.default_rng(seed)
    return _Gait(
        frames=int(generator.integers(30, 37)),
        stride=float(generator.uniform(1.0, 1.25)),
        arm=float(generator.uniform(0.25, 0.45)),
        trunk=float(generator.uniform(0.8, 1.2)),
    )


def _table(gait: _Gait) -> Array:
    """Frames (F, 44) as a DeepMimic clip has them, the last the first of the next cycle."""
    phase = np.arange(gait.frames + 1) / gait.frames
    swing = 2 * np.pi * phase
    pelvis = quat.multiply(
        quat.about("Y", np.radians(4) * gait.trunk * np.sin(swing)),
        quat.about("X", np.radians(2.5) * gait.trunk * np.sin(swing + 1.0)),
    )
    chest = quat.multiply(
        quat.about("Y", -np.radians(7) * gait.trunk * np.sin(swing)), quat.about("Z", -0.05)
    )
    feet = {"right": _foot(phase, gait), "left": _foot(phase + 0.5, gait)}
    feet["left"][0][:, 0] -= 0.5 * gait.stride
    across = OFFSETS[JOINT_NAMES.index("right_hip")]
    root = np.zeros((len(phase), 3))
    root[:, 0] = gait.stride * (phase - 0.22)
    root[:, 1] = 0.012 * np.cos(2 * swing - 2.4)
    root[:, 2] = 0.015 * np.sin(swing + 0.8)
    hips = {s: quat.rotate(pelvis, sign * across) for s, sign in (("right", 1), ("left", -1))}
    root[:, 1] += _height(root, hips, feet)
    legs = {side: _leg(root + hips[side], *feet[side], pelvis) for side in feet}
    arms = {side: _arm(swing + lag, gait) for side, lag in (("right", np.pi), ("left", 0.0))}
    neck = np.tile(quat.IDENTITY, (len(phase), 1))
    rows = [np.full((len(phase), 1), 1 / _FPS), root, pelvis, chest, neck]
    for side in ("right", "left"):
        rows += [*legs[side], *arms[side]]
    return np.concatenate(rows, axis=1)


def _eased(phase: Array, keys: tuple[tuple[float, float], ...]) -> Array:
    """Values at `phase` between keys, eased in and out at each by a smoothstep."""
    phases, values = np.array(keys).T
    place = np.clip(np.searchsorted(phases, phase, side="right") - 1, 0, len(phases) - 2)
    s = (phase - phases[place]) / (phases[place + 1] - phases[place])
    return values[place] + (values[place + 1] - values[place]) * s * s * (3 - 2 * s)


def _foot(phase: Array, gait: _Gait) -> tuple[Array, Array]:
    """Ankle positions (F, 3) and pitch (F,) radians, toe up; heel strike at whole phases."""
    turns = np.floor(phase + 1e-9)
    within = phase - turns
    pitch = np.radians(_eased(within, _PITCH))
    ankle = _standing(within, pitch)
    off, on = np.array([_STANCE]), np.array([1.0])
    leave = _standing(off, np.radians(_eased(off, _PITCH)))
    strike = _standing(on * 0.0, np.radians(_eased(on * 0.0, _PITCH)))
    strike[:, 0] += gait.stride
    s = np.clip((within - _STANCE) / (1 - _STANCE), 0.0, 1.0)[:, None]
    carry = leave + (strike - leave) * s**3 * (10 - 15 * s + 6 * s * s)
    carry[:, 1] += 0.045 * np.sin(np.pi * s[:, 0]) ** 2
    ankle = np.where(within[:, None] < _STANCE, ankle, carry)
    ankle[:, 0] += turns * gait.stride
    return ankle, pitch


def _standing(within: Array, pitch: Array) -> Array:
    """Ankle (N, 3) of a foot on the floor at the origin: it rolls over its heel, then its toe."""
    pivot = np.where(within < 0.24, _HEEL, _TOE)
    x = pivot - pivot * np.cos(pitch) + _SOLE * np.sin(pitch)
    y = -pivot * np.sin(pitch) - _SOLE * np.cos(pitch)
    return np.stack([x, y, np.zeros_like(x)], axis=-1)


def _height(root: Array, hips: dict[str, Array], feet: dict[str, tuple[Array, Array]]) -> float:
    """The height of the pelvis at which the farthest foot is just within reach."""
    reach = 0.985 * (_THIGH + _SHANK)
    heights = []
    for side, (ankle, _) in feet.items():
        ankle[:, 2] = 0.9 * np.mean(hips[side][:, 2])
        away = root + hips[side] - ankle
        heights.append(np.sqrt(reach**2 - away[:, 0] ** 2 - away[:, 2] ** 2) - away[:, 1])
    return float(np.min(heights))


def _leg(hip: Array, ankle: Array, pitch: Array, pelvis: Array) -> list[Array]:
    """Hip quaternion, knee angle and ankle quaternion that put the foot in its place."""
    away = ankle - hip
    distance = np.linalg.norm(away, axis=-1)
    cosine = (distance**2 - _THIGH**2 - _SHANK**2) / (2 * _THIGH * _SHANK)
    knee = -np.arccos(np.clip(cosine, -1.0, 1.0))
    local = np.stack([_SHANK * np.sin(knee), -_THIGH - _SHANK * np.cos(knee), 0 * knee], axis=-1)
    turn = np.concatenate(
        [(distance**2 + np.einsum("fi,fi->f", local, away))[:, None], quat.cross(local, away)],
        axis=-1,
    )
    thigh = quat.normalise(turn)
    shank = quat.multiply(thigh, quat.about("Z", knee))
    foot = quat.multiply(quat.inverse(shank), quat.about("Z", pitch))
    return [quat.multiply(quat.inverse(pelvis), thigh), knee[:, None], foot]


def _arm(swing: Array, gait: _Gait) -> list[Array]:
    """Shoulder quaternion and elbow angle of an arm that swings with `swing` (F,) radians."""
    shoulder = quat.about("Z", gait.arm * np.cos(swing) - 0.05)
    return [shoulder, (0.35 + 0.4 * gait.arm * np.cos(swing))[:, None]]
