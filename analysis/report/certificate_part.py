"""What was certified of a protocol before its data, quoted beside them."""

import json
from datetime import datetime
from pathlib import Path
from typing import Any

from analysis.report.context import Context
from analysis.report.parts import Section
from analysis.report.words import count, listing, rounded, share, signed

_FILE = "certificate.json"
# What a certificate would say, by task: what is simulated of a study depends on what it asks.
_UNKNOWN = {
    "odd-pair": "bias and coverage of its estimates under its own staircase are not known",
    "preference": "the power of its tests is not known",
}
_UNKNOWN_OTHERWISE = "what its answers come to, and how surely, is not known beforehand"


def certificates(data: list[Path]) -> dict[str, Any]:
    """Entries of certificate.json by protocol hash: beside the data, above them, or here."""
    found: dict[str, Any] = {}
    for folder in [Path(), *(near for path in data for near in (path.parent, path))]:
        try:
            held = json.loads((folder / _FILE).read_text(encoding="utf-8"))
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
                f"{_UNKNOWN.get(context.study.task, _UNKNOWN_OTHERWISE)}. “segue certify” "
                "simulates the protocol to find out.",
            ),
        )
    told = [
        f"Certified{_when(held, context)} ({held.get('simulated_sets', 'some')} simulated studies "
        f"of {_people(held.get('participants'))}):",
        *_estimates(held),
        *_power(held, context),
    ]
    return Section("What the design can show", text=(" ".join(told).rstrip(";:") + ".",))


def _when(held: dict[str, Any], context: Context) -> str:
    """Whether the certificate came before the first session; nothing where a time is missing."""
    flips = [session.sidecar.get("FirstFlip") for session in context.study.sessions]
    times = [float(flip) for flip in flips if isinstance(flip, int | float)]
    try:
        created = datetime.fromisoformat(str(held.get("created")))
    except ValueError:
        return ""
    if not times or created.tzinfo is None:
        return ""
    if created.timestamp() > min(times):
        return " after the first session of the data"
    # A session without a time may have come before the certificate.
    return " before the data" if len(times) == len(flips) else ""


def _estimates(held: dict[str, Any]) -> list[str]:
    return [
        f"on the {side['side']} side a true {signed(side['truth'])} is estimated as "
        f"{signed(side['fit']['mean'])} on average (SD {rounded(side['fit']['sd'])}), and the "
        f"95% interval covers it in {share(side['coverage'])} of studies;"
        for side in held.get("thresholds", [])
    ]


def _of_category(row: dict[str, Any]) -> str:
    return f" ({row['category']})" if row.get("category", "all") != "all" else ""


def _people(number: int | None) -> str:
    return "some people" if number is None else count(number, "person", "people")


def _power(held: dict[str, Any], context: Context) -> list[str]:
    """The number of people recommended, and the power at the number that the protocol states."""
    told = []
    if "recommended_for" in held:
        people = held.get("recommended_participants")
        found = f"{_people(people)} are" if people else "more people than could be tried are"
        told.append(f"{found} recommended ({held['recommended_for']});")
    rows = held.get("power", [])
    own = (context.protocol.get("participants"), held.get("participants"))
    stated = next((n for n in own if any(row["participants"] == n for row in rows)), None)
    powers = [
        f"{share(row['power'])} for an effect of {row['effect']:g}{_of_category(row)}"
        for row in rows
        if row["participants"] == stated
    ]
    if powers:
        what = f" of {held['power_of']}" if "power_of" in held else ""
        told.append(f"with {_people(stated)} the power{what} is {listing(powers)};")
    return told
