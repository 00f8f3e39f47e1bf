"""A study as Psych-DS has it: tables between commas, named by keywords, their columns described.

Psych-DS (psych-ds.github.io) asks for `dataset_description.json` in the words of schema.org, and
for tables `data/**/keyword-value_…_data.csv` whose columns it lists. The data set as it was
recorded lies in `data/raw`, which its validator is told to leave alone.
"""

import csv
import io
import json
import re
import shutil
from pathlib import Path
from typing import Any

from stimuli.files import write_atomic
from study.record.contents import KEYWORDS, Contents, cells, contents_of
from study.record.copies import made_from
from study.record.people import PARTICIPANT_COLUMNS

WHOSE = {"participant": "the participant", "session": "the session of this task, numbered from 1"}
_ENTITY = re.compile(r"([a-z]+)-([A-Za-z0-9]+)")


def pack_psych_ds(data: Path, out: Path) -> Contents:
    """Write a data set to the new folder `out` as Psych-DS; returns what it holds."""
    with made_from(data, out, "--psych-ds") as folder:
        held = contents_of(data)
        columns: dict[str, str] = {}
        for place in held.sidecars:
            columns |= _session(held, place, folder)
        columns |= _people(held, folder)
        for place in held.files:
            _copy(data / place, folder / _kept_at(place))
        for mark, protocol in held.protocols.items():
            name = f"{protocol.get('name', 'protocol')}-{mark[:8]}.json"
            _write(folder / "materials" / "protocols" / name, protocol)
        write_atomic(folder / "README.md", _readme(held))
        write_atomic(folder / ".psychdsignore", "data/raw/\n")
        _write(folder / "dataset_description.json", described(held, columns))
    return held


def _kept_at(place: str) -> str:
    """Where a file of the data set goes: reports are results, the rest is as it was recorded."""
    derived = place.removeprefix("derivatives/")
    return f"data/raw/{place}" if derived == place else f"results/{derived}"


def _session(held: Contents, place: str, folder: Path) -> dict[str, str]:
    """A session's table, whose rows say whose they are; its columns and what they mean."""
    entities = dict(_ENTITY.findall(Path(place).stem.removesuffix("_beh")))
    header, *rows = cells(held.data / place)
    who = entities["sub"]
    session = entities.get("run", "1")
    if "ses" in entities:
        session = f"{entities['ses']}run{session}"
    name = f"subject-{who}_task-{entities.get('task', 'none')}_session-{session}_data.csv"
    whose = [[who, session, *row] for row in rows]
    _table(folder / "data" / f"subject-{who}" / name, [[*WHOSE, *header], *whose])
    told = {key: column["Description"] for key, column in held.columns.items()}
    return WHOSE | {column: told.get(column, column) for column in header}


def _people(held: Contents, folder: Path) -> dict[str, str]:
    path = held.data / "participants.tsv"
    if not path.is_file():
        return {}
    header, *rows = cells(path)
    _table(folder / "data" / "description-participants_data.csv", [header, *rows])
    return {name: PARTICIPANT_COLUMNS.get(name, name) for name in header}


def described(held: Contents, columns: dict[str, str]) -> dict[str, Any]:
    """`dataset_description.json`, as schema.org describes a data set."""
    units = {name: told["Units"] for name, told in held.columns.items() if "Units" in told}
    document = {
        "@context": "https://schema.org/",
        "@type": "Dataset",
        "name": held.name,
        "description": held.description,
        "schemaVersion": "Psych-DS 1.5.1",
        "author": [{"@type": "Person", "name": name} for name in held.document.get("Authors", ())],
        "license": held.document.get("License", ""),
        "keywords": list(KEYWORDS),
        "variableMeasured": [
            {"@type": "PropertyValue", "name": name, "description": told}
            | ({"unitText": units[name]} if name in units else {})
            for name, told in columns.items()
        ],
    }
    return {key: value for key, value in document.items() if value}


def _readme(held: Contents) -> str:
    return f"""{held.name}
{"=" * len(held.name)}

{held.description}

`data/subject-*/` has a table for each session, a row a trial, which participant, session and trial
name together; `n/a` stands for what is missing. `dataset_description.json` says what each column
means. `data/raw/` is the data set as it was recorded (BIDS, `segue report data/raw` reads it), with
the seed of each session. `materials/protocols/` has the protocols whole.
"""


def _table(path: Path, rows: list[list[str]]) -> None:
    buffer = io.StringIO()
    csv.writer(buffer, lineterminator="\n").writerows(rows)
    write_atomic(path, buffer.getvalue())


def _copy(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source, target)


def _write(path: Path, document: Any) -> None:
    write_atomic(path, json.dumps(document, indent=2, ensure_ascii=False) + "\n")
