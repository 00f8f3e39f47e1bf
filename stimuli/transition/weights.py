"""Weights of the joints in the pose cost (Wang 2005, Table IV.1), by anatomical role."""

import json
import tomllib
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

import numpy as np

from stimuli.errors import InputError
from stimuli.motion.quaternions import Array
from stimuli.motion.roles import ROLES
from stimuli.motion.skeleton import Skeleton

Weights = Mapping[str, float]
SIDES = ("left", "right")
LIMB_ROLES = ("hip", "knee", "shoulder", "elbow")
MAJOR = tuple(f"{side}_{limb}" for limb in LIMB_ROLES for side in SIDES)


def tied(limbs: Mapping[str, float], trunk: Mapping[str, float] | None = None) -> Weights:
    """Weights with left and right alike, and those of the trunk."""
    sided = {f"{side}_{limb}": weight for limb, weight in limbs.items() for side in SIDES}
    return MappingProxyType(sided | dict(trunk or {}))


HEAVIEST = 1e6  # of a weight

WEIGHTS: Mapping[str, Weights] = MappingProxyType(
    {
        "lee": tied(dict.fromkeys(LIMB_ROLES, 1.0), {"pelvis": 1.0, "spine": 1.0}),
        "wang": tied({"hip": 1.0, "knee": 0.0901, "shoulder": 0.7884, "elbow": 0.0247}),
    }
)


def named_weights(weights: str | Weights) -> Weights:
    """A weight set by its name, or the one given; InputError for an unknown name."""
    if not isinstance(weights, str):
        return weights
    if weights not in WEIGHTS:
        raise InputError(
            f"weights: expected one of {', '.join(WEIGHTS)}, or a file, found {weights!r}."
        )
    return WEIGHTS[weights]


def weighted_joints(skeleton: Skeleton, weights: str | Weights) -> tuple[list[int], Array]:
    """Joints of the roles with a weight above 0, and those weights (K,)."""
    used = {role: weight for role, weight in named_weights(weights).items() if weight > 0}
    return skeleton.role(*used), np.array(list(used.values()))


def read_weights(name: str) -> Weights:
    """A weight set by its name, or from a TOML or JSON file of role = weight."""
    if name in WEIGHTS:
        return WEIGHTS[name]
    path = Path(name)
    todo = f"Give {', '.join(WEIGHTS)}, or a TOML or JSON file of role = weight."
    try:
        text = path.read_text(encoding="utf-8")
        document = json.loads(text) if path.suffix == ".json" else tomllib.loads(text)
    except OSError as error:
        missing = isinstance(error, FileNotFoundError)
        found = "no such file" if missing else (error.strerror or "no file").lower()
        found = found.removeprefix("is ")  # a directory
        raise InputError(f"{name}: expected weights, found {found}.\n{todo}") from None
    except UnicodeDecodeError:
        raise InputError(f"{name}: expected UTF-8, found another encoding.\n{todo}") from None
    except (ValueError, RecursionError) as error:
        kind = "JSON" if path.suffix == ".json" else "TOML"
        where = f" ({error})" if isinstance(error, ValueError) else ": nested too deep"
        raise InputError(f"{name}: expected weights, found no {kind}{where}.\n{todo}") from None
    table = document.get("weights", document) if isinstance(document, dict) else document
    if not isinstance(table, dict):
        raise InputError(f"{name}: expected role = weight, found {_short(table)}.\n{todo}")
    faults = [fault for role, weight in table.items() if (fault := _fault(role, weight))]
    if faults:
        raise InputError(f"{name}: {'; '.join(faults)}.\n{todo}")
    if not any(table.values()):
        raise InputError(f"{name}: expected a weight above 0, found none.\n{todo}")
    return MappingProxyType(
        {sided: float(weight) for role, weight in table.items() for sided in _sided(role)}
    )


def _sided(role: str) -> list[str]:
    """A role itself, or a limb's two sides."""
    return [role] if role in ROLES else [f"{side}_{role}" for side in SIDES]


def _fault(role: str, weight: object) -> str:
    """What is wrong with an entry of a file of weights; empty when nothing is."""
    if not set(_sided(role)) <= set(ROLES):
        return f"{_short(role)}: expected a role such as left_hip or hip"
    number = isinstance(weight, (int, float)) and not isinstance(weight, bool)
    if not (number and 0 <= weight <= HEAVIEST):  # type: ignore[operator]
        return f"{role}: expected a number from 0 to {HEAVIEST:g}, found {_short(weight)}"
    return ""


def _short(found: object) -> str:
    """What was found, as far as a line has room for it."""
    text = repr(found)
    return text if len(text) <= 60 else f"{text[:57]}…"
