"""The sidecar of a record: what is needed to replay it, and what each column means."""

import platform
from collections.abc import Mapping
from importlib import metadata
from typing import Any

from study.protocol.schema import ProtocolFile
from study.record.table import COMMON, FORMATS, MISSING
from study.trials.plan import Plan
from study.trials.tasks import Task, pages_of

VERSIONS_OF = ("segue", "psychopy", "numpy", "scipy", "av", "psychtoolbox", "pyglet", "PyOpenGL")


def sidecar_of(
    plan: Plan,
    task: Task,
    *,
    observer: str,
    display: Mapping[str, object],
    pace: float = 1.0,
    stimulus_set_hash: str = MISSING,
    **more: Any,
) -> dict[str, Any]:
    """The sidecar of a record at its start, not yet finished."""
    columns = {**COMMON, **task.columns}
    return {
        "TaskName": plan.protocol.name,
        "TaskDescription": plan.protocol.file.title,
        **_told(plan.protocol.file, task),
        "Protocol": dict(plan.protocol.document),
        "ProtocolHash": plan.protocol.hash,
        "StimulusSetHash": stimulus_set_hash,
        "ReferenceLengths": {m.name: m.reference for m in plan.motions if m.reference},
        "Seed": plan.seed,
        "Group": plan.group,
        "Observer": observer,
        "Pace": pace,
        "Rehearsal": plan.rehearsal,
        "Finished": False,
        "Display": dict(display),
        "SoftwareVersions": software_versions(),
        **more,
        **{name: {"Description": text, **FORMATS.get(name, {})} for name, text in columns.items()},
    }


def _told(file: ProtocolFile, task: Task) -> dict[str, str]:
    """What BIDS recommends to say of a task and its place, as far as the protocol says it."""
    lab = file.lab
    found = {
        "Instructions": "\n\n".join(pages_of(file, task)),
        "InstitutionName": lab.institution,
        "InstitutionalDepartmentName": lab.department,
        "InstitutionAddress": lab.address,
    }
    return {key: text for key, text in found.items() if text}


def software_versions() -> dict[str, str]:
    """The versions of what shows, times and records a session."""
    found = {"python": platform.python_version(), "system": platform.platform()}
    for name in VERSIONS_OF:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found
