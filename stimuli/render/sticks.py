"""A stick figure: capsules from joint to joint and a ball for a head, carried by the same bones."""

from dataclasses import replace

import numpy as np

from stimuli.render.landmarks import MIRRORED, Landmarks
from stimuli.render.parts import body_parts, trunk_bones
from stimuli.render.shapes import DENSE, Floats, Part

STICK = 0.012  # half the width of a stick, as a fraction of the stature
HEAD = 0.055
_LIMBS = ("upper_arm", "forearm", "hand", "thigh", "shank")


def stick_parts(marks: Landmarks, thickness: float = 1.0) -> tuple[Part, ...]:
    """Limbs, spine, lines across shoulders and hips, feet, head; lengths in metres."""
    parts = {part.name: part for part in body_parts(marks)}
    radius = STICK * marks.stature * thickness
    at = marks.points
    chest = f"trunk{len(marks.trunk) - 1}"
    top, hips = at["trunk_top"], at["hips"]
    spine = _line(parts["torso"], "spine", hips, top, radius, trunk_bones(marks))
    neck = _line(parts["neck"], "neck", top, at["skull"], radius, parts["neck"].bones)
    sticks = [spine, neck, _ball(parts["cranium"], HEAD * marks.stature)]
    for side, _ in MIRRORED:
        shoulder, hip = at[f"{side}_shoulder"], at[f"{side}_hip"]
        across = ((0.3, chest), (0.9, f"{side}_clavicle"))
        sticks.append(_line(parts["torso"], f"{side}_shoulder", top, shoulder, radius, across))
        sticks.append(_line(parts["torso"], f"{side}_hip", hips, hip, radius, ((0.0, "trunk0"),)))
        for limb in _LIMBS:
            part = parts[f"{side}_{limb}"]
            sticks.append(_line(part, part.name, part.start, part.end, radius, part.bones))
        toes = parts[f"{side}_toes"]
        bones = ((0.3, f"{side}_ankle"), (0.9, f"{side}_toe"))
        sticks.append(_line(toes, f"{side}_foot", at[f"{side}_ankle"], toes.end, radius, bones))
    return tuple(sticks)


def _line(
    like: Part,
    name: str,
    start: Floats,
    end: Floats,
    radius: float,
    bones: tuple[tuple[float, str], ...],
) -> Part:
    """A round capsule; its side is any direction across it."""
    axis = end - start
    side = np.eye(3)[int(np.argmin(np.abs(axis)))]
    wide = np.full(DENSE, radius)
    return replace(
        like, name=name, start=start, end=end, side=side, widths=wide, depths=wide,
        shift=np.zeros(DENSE), caps=(radius, radius), bones=bones, floor=None,
    )  # fmt: skip


def _ball(like: Part, radius: float) -> Part:
    wide = np.full(DENSE, radius)
    return replace(like, widths=wide, depths=wide, caps=(radius, radius))
