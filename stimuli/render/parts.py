"""The parts of a human body: where they lie between landmarks and how thick they are.

Half-widths and half-depths are fractions of the stature; the table is of a slim, sex-neutral
figure, the same for every skeleton.
"""

from dataclasses import replace

import numpy as np

from stimuli.motion.quaternions import Array
from stimuli.render.landmarks import MIRRORED, Landmarks
from stimuli.render.shapes import DENSE, Part, profile

LEFT, UP, AHEAD = np.eye(3)

TORSO_WIDTHS = (0.083, 0.088, 0.087, 0.085, 0.087, 0.090, 0.092, 0.091, 0.090)
# of front and back from the axis: the waist hardly drawn in, as any dip there shades as a ridge
_TORSO_FRONT = (0.056, 0.0595, 0.059, 0.058, 0.059, 0.0605, 0.0605, 0.059, 0.058)
_TORSO_BACK = (0.058, 0.062, 0.060, 0.0585, 0.060, 0.062, 0.062, 0.060, 0.059)
TORSO_DEPTHS = tuple((a + b) / 2 for a, b in zip(_TORSO_FRONT, _TORSO_BACK, strict=True))
TORSO_SHIFT = tuple((a - b) / 2 for a, b in zip(_TORSO_FRONT, _TORSO_BACK, strict=True))
DOME = 0.036  # below the trunk's top, where the torso begins to round off
_THIGH = (0.0505, 0.0515, 0.044, 0.0335, 0.0295)
_SHANK = (0.0295, 0.030, 0.0325, 0.0255, 0.019)
UPPER_ARM = (0.029, 0.030, 0.0265, 0.0215, 0.0205)
AS_THEY_ARE = ("cranium", "face", "nose", "hand", "thumb", "heel", "foot", "toes")
FOREARM = (0.0205, 0.0225, 0.0205, 0.0165, 0.0150)


def body_parts(marks: Landmarks, thickness: float = 1.0) -> tuple[Part, ...]:
    """All parts, limb by limb; within a limb each is joined to those before it.

    `thickness` multiplies the girth of all but heads, hands and feet.
    """
    limbs = [*_trunk(marks), *_head(marks)]
    for side, sign in MIRRORED:
        limbs += [*_arm(marks, side, sign), *_leg(marks, side)]
    return tuple(_thickened(part, thickness) for part in limbs)


def _thickened(part: Part, thickness: float) -> Part:
    if thickness == 1.0 or part.name.endswith(AS_THEY_ARE):
        return part
    return replace(part, widths=part.widths * thickness, depths=part.depths * thickness)


def _part(
    marks: Landmarks,
    name: str,
    ends: tuple[Array, Array],
    widths: tuple[float, ...],
    bones: tuple[tuple[float, str], ...],
    *,
    limb: str,
    blend: float,
    depths: tuple[float, ...] | None = None,
    side: Array = LEFT,
    shift: tuple[float, ...] = (0.0,),
    caps: tuple[float, float] | None = None,
    floor: float | None = None,
) -> Part:
    """A part whose measures are fractions of the stature; round ends unless `caps` are given."""
    size = marks.stature
    wide, deep = profile(widths, size), profile(depths or widths, size)
    rounded = (caps[0] * size, caps[1] * size) if caps else (deep[0], deep[DENSE - 1])
    return Part(
        name, ends[0], ends[1], side, wide, deep, profile(shift, size),
        (float(rounded[0]), float(rounded[1])), bones, limb, blend * size, floor,
    )  # fmt: skip


def trunk_bones(marks: Landmarks) -> tuple[tuple[float, str], ...]:
    """Which trunk joint carries the torso at which place, faded from one to the next."""
    bottom, top = marks.points["hips"][1], marks.points["trunk_top"][1]
    heights = [marks.points[f"trunk{k}"][1] for k in range(len(marks.trunk))]
    edges = np.clip((np.array([*heights, top]) - bottom) / (top - bottom), 0.0, 1.0)
    edges[0] = 0.0
    middles = (edges[:-1] + edges[1:]) / 2
    middles = np.maximum.accumulate(middles) + 1e-6 * np.arange(len(middles))
    return tuple((float(place), f"trunk{k}") for k, place in enumerate(middles))


def _trunk(marks: Landmarks) -> list[Part]:
    at, size = marks.points, marks.stature
    chest = f"trunk{len(marks.trunk) - 1}"
    parts = [
        _part(
            marks, "torso", (at["hips"], at["trunk_top"] - DOME * size * UP), TORSO_WIDTHS,
            trunk_bones(marks),
            depths=TORSO_DEPTHS, shift=TORSO_SHIFT,
            caps=(0.070, 0.036 + DOME), limb="trunk", blend=0.061,
        )
    ]  # fmt: skip
    for side, sign in MIRRORED:
        root = at["nape"] + np.array([sign * 0.014, 0.020, -0.006]) * size
        tip = at[f"{side}_shoulder"] + np.array([-sign * 0.016, 0.003, 0.0]) * size
        bones = ((0.2, chest), (0.8, f"{side}_clavicle"))
        parts.append(
            _part(
                marks, f"{side}_trapezius", (root, tip), (0.028, 0.028, 0.028, 0.028), bones,
                side=AHEAD, limb="trunk", blend=0.072, depths=(0.018, 0.020, 0.023, 0.025),
            )
        )  # fmt: skip
    return parts


def _head(marks: Landmarks) -> list[Part]:
    skull, size = marks.points["skull"], marks.stature
    chest = f"trunk{len(marks.trunk) - 1}"
    head = ((0.0, "head"),)

    def near(*offset: float) -> Array:
        return np.asarray(skull + np.array(offset) * size)

    neck = (marks.points["nape"] - np.array([0, 0.03, 0.006]) * size, near(0, -0.038, -0.020))
    return [
        _part(
            marks, "neck", neck, (0.036, 0.0315, 0.0305, 0.031),
            ((0.0, chest), (0.4, "neck"), (0.95, "head")), limb="trunk", blend=0.032,
        ),
        _part(
            marks, "cranium", (near(0, -0.001, -0.001), near(0, 0.001, -0.001)), (0.0435,), head,
            depths=(0.0535,), caps=(0.052, 0.053), limb="trunk", blend=0.032,
        ),
        _part(
            marks, "face", (near(0, -0.030, 0.0170), near(0, -0.034, 0.0190)), (0.0325,), head,
            depths=(0.0345,), caps=(0.044, 0.043), limb="trunk", blend=0.023,
        ),
        _part(
            marks, "nose", (near(0, -0.004, 0.0475), near(0, -0.027, 0.0570)),
            (0.0045, 0.0055, 0.0072), head, limb="trunk", blend=0.020,
        ),
    ]  # fmt: skip


def _arm(marks: Landmarks, side: str, sign: float) -> list[Part]:
    at, size, limb = marks.points, marks.stature, f"{side}_arm"
    shoulder, elbow, wrist, tip = (
        at[f"{side}_{point}"] for point in ("shoulder", "elbow", "wrist", "fingertip")
    )
    hand = tip - wrist
    aside = AHEAD - hand * (AHEAD @ hand) / (hand @ hand)
    thumb = (wrist + 0.22 * hand + 0.014 * size * aside, wrist + 0.60 * hand + 0.030 * size * aside)
    carried = ((0.0, f"{side}_wrist"),)
    return [
        _part(
            marks, f"{side}_upper_arm", (shoulder, elbow), UPPER_ARM,
            ((0.1, f"{side}_shoulder_twist"), (0.7, f"{side}_shoulder")),
            side=AHEAD, limb=limb, blend=0.046,
        ),
        _part(
            marks, f"{side}_forearm", (elbow, wrist), FOREARM,
            ((0.3, f"{side}_elbow"), (0.9, f"{side}_elbow_twist")),
            side=AHEAD, limb=limb, blend=0.004,
            depths=(0.0205, 0.0225, 0.0190, 0.0145, 0.0130),
        ),
        _part(
            marks, f"{side}_hand", (wrist, tip - 0.1 * hand),
            (0.0165, 0.0235, 0.0240, 0.0205, 0.0150), carried,
            depths=(0.0130, 0.0145, 0.0125, 0.0105, 0.0085), side=aside,
            caps=(0.012, 0.012), limb=limb, blend=0.017,
        ),
        _part(
            marks, f"{side}_thumb", thumb, (0.0090, 0.0085, 0.0070), carried,
            side=aside, limb=limb, blend=0.017,
        ),
    ]  # fmt: skip


def _leg(marks: Landmarks, side: str) -> list[Part]:
    at, size, limb, sole = marks.points, marks.stature, f"{side}_leg", marks.sole
    hip, knee, ankle = (at[f"{side}_{point}"] for point in ("hip", "knee", "ankle"))
    ahead = at[f"{side}_ahead"]
    across = np.cross(UP, ahead)

    def foot(along: float, height: float) -> Array:
        return np.asarray(ankle * [1, 0, 1] + ahead * along * size + UP * (sole + height * size))

    carried = ((0.0, f"{side}_ankle"),)
    toes = ((0.1, f"{side}_ankle"), (0.4, f"{side}_toe"))
    return [
        _part(
            marks, f"{side}_thigh", (hip, knee), _THIGH,
            ((0.1, f"{side}_hip_twist"), (0.7, f"{side}_hip")),
            shift=(0.010, 0.004, 0.0, 0.0, 0.0), limb=limb, blend=0.058,
        ),
        _part(
            marks, f"{side}_shank", (knee, ankle), _SHANK, ((0.0, f"{side}_knee"),),
            shift=(0.0, 0.007, 0.008, 0.003, 0.0), limb=limb, blend=0.004,
        ),
        _part(
            marks, f"{side}_heel", (foot(-0.012, 0.020), foot(0.020, 0.026)), (0.0185, 0.021),
            carried, depths=(0.021, 0.026), side=across, caps=(0.015, 0.02), limb=limb,
            blend=0.020, floor=sole,
        ),
        _part(
            marks, f"{side}_foot", (foot(0.015, 0.024), foot(0.074, 0.013)),
            (0.0205, 0.0230, 0.0250), carried, depths=(0.0235, 0.0190, 0.0140), side=across,
            limb=limb, blend=0.026, floor=sole,
        ),
        _part(
            marks, f"{side}_toes", (foot(0.066, 0.0105), foot(0.098, 0.0095)),
            (0.0250, 0.0250, 0.0210), toes, depths=(0.0130, 0.0120, 0.0105), side=across,
            caps=(0.015, 0.015), limb=limb, blend=0.020, floor=sole,
        ),
    ]  # fmt: skip
