"""A study as an RO-Crate 1.1: the data set with `ro-crate-metadata.json`, every file described."""

from pathlib import Path
from typing import Any

from stimuli.errors import InputError
from study.record.contents import (
    KEYWORDS,
    Contents,
    contents_of,
    format_of,
    told_of_file,
)
from study.record.copies import made_from

VERSION = "1.1"  # which all that read RO-Crates know
LICENCES = {
    "CC0": "https://creativecommons.org/publicdomain/zero/1.0/",
    "PDDL": "https://opendatacommons.org/licenses/pddl/1-0/",
    "CC-BY-4.0": "https://creativecommons.org/licenses/by/4.0/",
    "CC-BY-SA-4.0": "https://creativecommons.org/licenses/by-sa/4.0/",
}
PROGRAMS = {
    "segue": "shows the trials, keeps their record",
    "psychopy": "opens the window, reads the keyboard",
}


def pack_crate(data: Path, out: Path) -> Contents:
    """Write a data set to the new folder `out` as an RO-Crate; returns what it holds.

    Raises InputError where the library rocrate is not installed.
    """
    try:
        from rocrate.rocrate import ROCrate
    except ImportError as error:
        raise InputError(
            "--ro-crate: expected the library rocrate, found none; `pip install 'segue[export]'`"
        ) from error
    with made_from(data, out, "--ro-crate") as folder:
        held = contents_of(data)
        crate = ROCrate(version=VERSION)
        _root(crate, held)
        for place in held.files:
            told = {"name": place, "description": told_of_file(place),
                    "encodingFormat": format_of(place)}  # fmt: skip
            crate.add_file(data / place, place, properties=told, record_size=True)
        crate.write(folder)
    return held


def _root(crate: Any, held: Contents) -> None:
    """Name, licence and authors of the whole, its columns, and what it was recorded with."""
    from rocrate.model.contextentity import ContextEntity
    from rocrate.model.person import Person

    def add(identifier: str, kind: str, **told: Any) -> Any:
        return crate.add(ContextEntity(crate, identifier, properties={"@type": kind, **told}))

    root = crate.root_dataset
    crate.name = held.name
    crate.description = held.description
    crate.keywords = ", ".join(KEYWORDS)
    if told := held.document.get("License"):
        address = LICENCES.get(str(told).upper(), "#licence")
        crate.license = add(address, "CreativeWork", name=str(told))
    people = [
        crate.add(Person(crate, f"#author-{n}", properties={"name": name}))
        for n, name in enumerate(held.document.get("Authors", ()), start=1)
    ]
    if people:
        root["author"] = people
    root["variableMeasured"] = [
        add(f"#column-{name}", "PropertyValue", name=name, description=column["Description"])
        for name, column in held.columns.items()
    ]
    versions = {
        (name, str(sidecar["SoftwareVersions"][name])): None
        for sidecar in held.sidecars.values()
        for name in PROGRAMS
        if name in sidecar.get("SoftwareVersions", {})
    }
    programs = [
        add(f"#{name}-{version}", "SoftwareApplication", name=name, version=version,
            description=PROGRAMS[name])
        for name, version in versions
    ]  # fmt: skip
    if programs:
        made = {"instrument": programs, "result": root}
        root["mentions"] = add("#sessions", "CreateAction", name="the sessions", **made)
