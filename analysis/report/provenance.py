"""Versions and hashes from stimulus to statistic."""

import platform
from importlib import metadata
from typing import Any

from analysis.report.context import Context
from analysis.report.parts import Section
from analysis.report.words import listing

_STATISTICS = ("segue", "numpy", "scipy", "pandas", "statsmodels", "matplotlib")


def versions() -> dict[str, str]:
    """The versions that computed the statistics."""
    found = {"python": platform.python_version()}
    for name in _STATISTICS:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def provenance(context: Context) -> dict[str, Any]:
    """Hashes, seeds, displays and versions of a study, from the sidecars."""
    sidecars = [session.sidecar for session in context.study.sessions]
    return {
        "protocol_hash": _distinct(sidecars, "ProtocolHash"),
        "stimulus_set_hash": _distinct(sidecars, "StimulusSetHash"),
        "observer": _distinct(sidecars, "Observer"),
        "display": _distinct(sidecars, "Display"),
        "session_versions": _distinct(sidecars, "SoftwareVersions"),
        "seeds": [sidecar.get("Seed") for sidecar in sidecars if "Seed" in sidecar],
        "analysis_versions": versions(),
        "analysis_seed": context.seed,
    }


def provenance_section(context: Context) -> Section:
    told = provenance(context)
    facts = [
        ("Protocol", listing([str(v) for v in told["protocol_hash"]]) or "not recorded"),
        ("Stimulus set", listing([str(v) for v in told["stimulus_set_hash"]]) or "not recorded"),
        *((f"Display {n}", _pairs(v)) for n, v in enumerate(told["display"], start=1)),
        *(("Sessions ran on", _pairs(v)) for v in told["session_versions"]),
        ("Statistics by", _pairs(told["analysis_versions"])),
        ("Seeds of sessions", ", ".join(map(str, told["seeds"])) or "not recorded"),
        ("Seed of resampling", str(context.seed)),
    ]
    return Section("From stimulus to statistic", facts=tuple(facts))


def _pairs(value: Any) -> str:
    if not isinstance(value, dict):
        return str(value)
    return ", ".join(f"{name} {_plain(held)}" for name, held in value.items())


def _plain(value: Any) -> str:
    return " × ".join(map(str, value)) if isinstance(value, list) else str(value)


def _distinct(sidecars: list[dict[str, Any]], key: str) -> list[Any]:
    found: list[Any] = []
    for sidecar in sidecars:
        if key in sidecar and sidecar[key] not in found:
            found.append(sidecar[key])
    return found
