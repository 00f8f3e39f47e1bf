"""Records as the field's own validator reads them."""

import json
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from study.protocol.protocol import shipped
from study.session.simulation import simulate
from study.trials.reading import parse_protocol

VALIDATOR = Path(sys.executable).parent / "bids-validator-deno"
# What no protocol can know, or what the whole data set's owner has to say.
UNKNOWN = {
    ("SIDECAR_KEY_RECOMMENDED", "CogAtlasID"),
    ("SIDECAR_KEY_RECOMMENDED", "CogPOID"),
    ("JSON_KEY_RECOMMENDED", "HEDVersion"),
    ("JSON_KEY_RECOMMENDED", "SourceDatasets"),
}
LAB = """
[lab]
authors = ["A. Experimenter", "B. Experimenter"]
institution = "A university"
department = "Psychology"
address = "1 Campus Road"
license = "CC0"
"""


def issues(folder: Path) -> Counter[tuple[str, str, str | None]]:
    """What the validator says of a data set, by severity, code and key; all rows are read."""
    command = shutil.which(str(VALIDATOR)) or shutil.which("bids-validator-deno")
    assert command is not None
    done = subprocess.run(
        [command, "--max-rows", "-1", "--format", "json", str(folder)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    found = json.loads(done.stdout)["issues"]["issues"]
    return Counter((i["severity"], i["code"], i.get("subCode")) for i in found)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One simulated person of a protocol of each task."""
    folder = tmp_path_factory.mktemp("bids") / "data"
    for name in ("jnd-center", "study-one", "weights"):
        protocol = parse_protocol(shipped()[name].read_text(encoding="utf-8") + LAB)
        simulate(protocol, {"locomotion": 10, "dance": 10}, 1, 5, folder, workers=1)
    return folder


def test_records_have_no_error_and_no_warning_that_a_protocol_could_mend(recorded: Path) -> None:
    found = issues(recorded)
    assert {key for key in found if key[1:] not in UNKNOWN} == set()


def test_a_fault_is_seen(recorded: Path, tmp_path: Path) -> None:
    """The validator reads what we think it does."""
    spoiled = shutil.copytree(recorded, tmp_path / "data")
    table = next(spoiled.glob("sub-*/beh/*_beh.tsv"))
    table.write_text(table.read_text().replace("\t0\t", "\t0\textra\t", 1))
    assert any(severity == "error" for severity, _, _ in issues(spoiled))
