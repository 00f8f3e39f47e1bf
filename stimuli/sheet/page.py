"""One HTML file in which a set's clips play, side by side and in step, without a network.

Each picture is there once, however many clips show it, and every clip is a list of pictures: the
frame that is shown is the one that is named, in any browser, which a video does not promise.
"""

import base64
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from stimuli.files import write_atomic
from stimuli.sets.manifest import ClipEntry, Manifest
from stimuli.sheet.gathered import MotionSheet, blend, label

TOLD_MEASURES = {  # what each is called in the page, its unit, by what it is multiplied
    "velocity_jump": ("velocity jump", "cm/frame", 100.0),
    "acceleration_jump": ("acceleration jump", "cm/frame²", 100.0),
    "foot_slide": ("foot slide", "cm/frame", 100.0),
    "geodesic_cost": ("geodesic cost", "", 1.0),
    "displacement_before": ("before", "cm", 100.0),
    "displacement_from_reference": ("in the blend", "cm", 100.0),
    "displacement_after": ("after", "cm", 100.0),
    "picture_before": ("before", "°", 1.0),
    "picture_in": ("in the blend", "°", 1.0),
    "picture_after": ("after", "°", 1.0),
}
GROUPS = (("", 4), ("from the reference, in space", 3), ("from the reference, seen", 3))


def write_page(manifest: Manifest, shown: Sequence[MotionSheet], path: Path) -> None:
    """Write the page, whole or not at all."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("stimuli.sheet", "."), autoescape=True, undefined=StrictUndefined
    )
    page = environment.get_template("sheet.html").render(
        manifest=manifest,
        motions=[_motion(each, manifest.pairings[each.motion]) for each in shown],
        measures=[(name, unit) for name, unit, _ in TOLD_MEASURES.values()],
        groups=GROUPS,
        drivers=sorted({d for e in manifest.clips for d in e.document.get("drivers", ())}),
        data={
            "fps": manifest.fps,
            "motions": [_played(each) for each in shown],
        },
    )
    write_atomic(path, page)


def _motion(shown: MotionSheet, pairing: Mapping[str, Any]) -> dict[str, Any]:
    """What the page says of a motion and of each of its clips."""
    return {
        "name": shown.motion,
        "category": pairing.get("category", ""),
        "from": pairing["from"],
        "to": pairing["to"],
        "frames": shown.clips[0].frames,
        "size": shown.size,
        "clips": [
            {
                "label": label(entry, pairing),
                "hash": entry.hash,
                "blend": blend(entry),
                "measures": [_told(entry, key) for key in TOLD_MEASURES],
                "warnings": entry.document.get("warnings", []),
            }
            for entry in shown.clips
        ],
    }


def _told(entry: ClipEntry, key: str) -> str:
    value = entry.document.get("measures", {}).get(key)
    if value is None:
        return "–"
    scaled = value * TOLD_MEASURES[key][2]
    return "0" if scaled == 0 else f"{scaled:.3g}"


def _played(shown: MotionSheet) -> dict[str, Any]:
    """What the page's player needs of a motion."""
    return {
        "frames": [list(frames) for frames in shown.frames],
        "blends": [list(blend(entry)) for entry in shown.clips],
        "images": [base64.b64encode(image).decode("ascii") for image in shown.images],
    }
