"""Point-light walkers (Johansson 1973): dots at places of the body, and their usual controls.

- `inverted`: the display stands on its head.
- `scrambled`: each dot keeps its own motion and starts from a random place in the area of the
  body (Cutting 1981; Troje and Westhoff 2006).
- `phase-scrambled`: each dot stays where it is and moves out of step with the others, its motion
  relative to the pelvis shifted in time by a random part of the clip.

Draws come from `control_seed` alone, so that the clips of a group are disturbed alike.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from stimuli.errors import InputError
from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.render.appearance import Appearance
from stimuli.render.landmarks import MIRRORED
from stimuli.render.rig import Rig
from stimuli.render.skin import Skin

RIM = 24  # points of a disc's rim
PAIRED = {"shoulders": "shoulder", "elbows": "elbow", "wrists": "wrist", "hips": "hip",
          "knees": "knee", "ankles": "ankle", "toes": "toe"}  # fmt: skip
SINGLE = {"head": "head", "neck": "neck", "pelvis": "trunk0"}
DOTS = (*SINGLE, *PAIRED)
AREA = (0.25, 0.15)  # of the stature: half the width and half the depth of a body
UNDER_JOINTS = 0.03  # of the stature, that soles are below the lowest joint
HEAD_ABOVE = 0.06  # of the stature, that the head's dot lies above the head's joint


def dot_places(rig: Rig, places: Sequence[str]) -> list[int]:
    """The bones of the rig that carry the dots at `places`, in order; left before right.

    InputError for a place that is none, or no place at all.
    """
    if unknown := [place for place in places if place not in DOTS]:
        raise InputError(f"dots: expected places among {', '.join(DOTS)}; found {unknown[0]!r}.")
    if not places:
        raise InputError(f"dots: expected places among {', '.join(DOTS)}; found none.")
    names = [
        name
        for place in places
        for name in (
            [SINGLE[place]]
            if place in SINGLE
            else [f"{side}_{PAIRED[place]}" for side, _ in MIRRORED]
        )
    ]
    return [rig.names.index(name) for name in names]


def dot_skin(count: int) -> Skin:
    """Discs, each on a bone of its own, in the order of the bones."""
    angle = np.linspace(0, 2 * np.pi, RIM, endpoint=False)
    rim = np.concatenate([[[0.0, 0.0]], np.stack([np.cos(angle), np.sin(angle)], axis=-1)])
    around = np.arange(RIM)
    fan = np.stack([np.zeros(RIM, int), 1 + around, 1 + (around + 1) % RIM], axis=-1)
    faces = (fan + (RIM + 1) * np.arange(count)[:, None, None]).reshape(-1, 3)
    size = count * (RIM + 1)
    single = np.float32
    return Skin(
        np.zeros((size, 3), single), np.tile(np.array([0, 0, 1], single), (size, 1)),
        faces.astype(np.int32), np.repeat(np.eye(count, dtype=single), RIM + 1, axis=0),
        np.ones(size, single), np.zeros(size, single), np.tile(rim, (count, 1)).astype(single),
    )  # fmt: skip


def dot_bones(rig: Rig, look: Appearance, stature: float, bones: Array) -> Array:
    """(F, D, 8) moves of a point-light walker's dots, from those of the rig's bones (F, B, 8).

    InputError for a control that is not in the table.
    """
    if look.control not in CONTROLS:
        raise InputError(f"control: expected one of {', '.join(CONTROLS)}, found {look.control!r}.")
    chosen = dot_places(rig, look.dots)
    rest = rig.reference.positions[rig.joints[chosen]].copy()
    heads = [rig.names[bone] == "head" for bone in chosen]
    rest[heads] += [0.0, HEAD_ABOVE * stature, 0.0]
    places = _moved(bones[:, chosen], rest)
    pelvis = _moved(bones[:, :1], rig.reference.positions[rig.joints[:1]] * [1.0, 0.0, 1.0])
    generator = np.random.default_rng([look.control_seed, len(chosen)])
    low = float(rig.reference.positions[:, 1].min()) - UNDER_JOINTS * stature
    shown = CONTROLS[look.control](places, pelvis, rest, (low, low + stature), generator)
    still = np.zeros((*shown.shape[:2], 8))
    still[..., 0] = 1.0
    still[..., 5:] = shown / 2
    return still


# Places (F, D, 3) of the dots and (F, 1, 3) of the pelvis, both in metres; where the dots are at
# rest (D, 3), and how low and high the body reaches there; what draws.
Control = Callable[[Array, Array, Array, tuple[float, float], np.random.Generator], Array]


def control_none(
    places: Array, pelvis: Array, rest: Array, reach: tuple[float, float],
    generator: np.random.Generator,
) -> Array:  # fmt: skip
    """The walker itself."""
    return places


def control_inverted(
    places: Array, pelvis: Array, rest: Array, reach: tuple[float, float],
    generator: np.random.Generator,
) -> Array:  # fmt: skip
    """Upside down, about half the height of a body that stands where it is at first."""
    turned = places.copy()
    turned[..., 1] = 2 * (float(pelvis[0, 0, 1]) + (reach[0] + reach[1]) / 2) - places[..., 1]
    return turned


def control_scrambled(
    places: Array, pelvis: Array, rest: Array, reach: tuple[float, float],
    generator: np.random.Generator,
) -> Array:  # fmt: skip
    """Each dot's way moved as a whole, to start from a random place in the area of the body."""
    wide, deep = np.array(AREA) * (reach[1] - reach[0])
    draws = generator.uniform([-wide, reach[0], -deep], [wide, reach[1], deep], size=rest.shape)
    return places + (draws - rest)


def control_phase_scrambled(
    places: Array, pelvis: Array, rest: Array, reach: tuple[float, float],
    generator: np.random.Generator,
) -> Array:  # fmt: skip
    """Each dot's motion about the pelvis shifted in time, by as many frames as are drawn for it.

    Where the clip ends, a dot goes back the way that it came: there is no jump.
    """
    count = len(places)
    about = places - pelvis
    there_and_back = np.concatenate([about, about[::-1]])
    shifts = [int(generator.integers(count)) for _ in range(places.shape[1])]
    shown = [there_and_back[shift : shift + count, dot] for dot, shift in enumerate(shifts)]
    return np.asarray(pelvis + np.stack(shown, axis=1))


CONTROLS: Mapping[str, Control] = {
    "none": control_none,
    "scrambled": control_scrambled,
    "inverted": control_inverted,
    "phase-scrambled": control_phase_scrambled,
}


def _moved(bones: Array, rest: Array) -> Array:
    """(F, D, 3) points at rest (D, 3), each moved by its own bone (F, D, 8)."""
    real, dual = bones[..., :4], bones[..., 4:]
    shift = 2.0 * quat.multiply(dual, quat.inverse(real))[..., 1:]
    return np.asarray(quat.rotate(real, rest) + shift)
