"""What was certified of a protocol before its data, quoted beside them."""

import json
from pathlib import Path
from typing import Any

from analysis.report.context import Context
from analysis.report.parts import Section
from analysis.report.words import number, share, signed

NAME = "certificate.json"
# What a certificate would say, by task: what is simulated of a study depends on what it asks.
MISSING = {
    "odd-pair": "bias and coverage of its estimates under its own staircase are not known",
    "preference": "the power of its tests is not known",
}
MISSING_OTHERWISE = "how long its sessions take and how they are balanced is not known beforehand"


def certificates(data: list[Path]) -> dict[str, Any]:
    """Entries of certificate.json by protocol hash: beside the data, above them, or here."""
    found: dict[str, Any] = {}
    for folder in [Path(), *(near for path in data for near in (path.parent, path))]:
        try:
            held = json.loads((folder / NAME).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            continue
        if isinstance(held, dict):
            found |= {key: value for key, value in held.items() if isinstance(value, dict)}
    return found


def certificate_section(context: Context) -> Section:
    """The certificate in a sentence or two, or that there is none."""
    held = context.certificate
    if held is None:
        return Section(
            "What the design can show",
            text=(
                "There is no certificate of this protocol: "
                f"{MISSING.get(context.study.task, MISSING_OTHERWISE)}. “segue certify” simulates "
                "the protocol to find out.",
            ),
        )
    told = [
        f"Certified before the data ({held.get('simulated_sets', 'some')} simulated studies of "
        f"{held.get('participants', 'some')} people):"
    ]
    for side in held.get("thresholds", []):
        told.append(
            f"on the {side['side']} side a true {signed(side['truth'])} is estimated as "
            f"{signed(side['fit']['mean'])} on average (SD {number(side['fit']['sd'])}), and the "
            f"95% interval covers it in {share(side['coverage'])} of studies;"
        )
    for test in held.get("power", [])[:3]:
        told.append(
            f"with {test['participants']} people the power for an effect of {test['effect']:g} is "
            f"{share(test['power'])};"
        )
    return Section("What the design can show", text=(" ".join(told).rstrip(";:") + ".",))
