"""A motion that changed after its set was rendered is noticed before a session, and only that."""

from pathlib import Path

import pytest

from stimuli.errors import InputError
from stimuli.motion import Library, write_walker
from stimuli.sets import Manifest, build, load_manifest
from study.protocol.protocol import Protocol
from study.protocol.sets import set_spec
from study.session.lab import Request, run_session
from study.session.stage import Nowhere
from study.trials.reading import load_protocol

PROTOCOL = """
name = "mine"
task = "preference"
methods = ["fixed", "cut"]
[stimuli]
seconds = 0.5
motions = [{ name = "m", from = "a", to = "b" }]
[sets.generated]
a = { clip = "generated-walker-0", frame = 3 }
b = { clip = "generated-walker-1", frame = 5 }
[appearance]
width = 64
height = 64
style = "mannequin"
[observer]
prefer = { fixed = 0.8, cut = 0.2 }
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sources")
    for seed in (0, 1):
        write_walker(folder / "motions", seed)
    (folder / "mine.toml").write_text(PROTOCOL)
    library = Library([folder / "motions"])
    build(set_spec(protocol_in(folder), None, library), library, folder / "set", workers=1)
    return folder


def protocol_in(folder: Path) -> Protocol:
    return load_protocol(folder / "mine.toml")


def session(place: Path, manifest: Manifest, data: Path) -> None:
    request = Request("p1", data, observer="simulated", seed=1)
    run_session(request, protocol_in(place), manifest, lambda _: True, lambda *_: Nowhere(0.5, 0.5))


def test_only_another_motion_under_the_name_is_refused(place: Path, tmp_path: Path) -> None:
    manifest = load_manifest(place / "set")
    session(place, manifest, tmp_path / "before")
    one, other = (next((place / "motions").glob(f"generated-walker-{n}.*")) for n in (0, 1))
    content = one.read_bytes()
    try:
        one.write_bytes(content.rstrip() + b"\n\n")  # another file, the same motion
        session(place, manifest, tmp_path / "same")
        one.write_bytes(other.read_bytes())
        with pytest.raises(InputError, match="found generated-walker-0 changed since") as caught:
            session(place, manifest, tmp_path / "changed")
        assert "segue render" in str(caught.value).splitlines()[1]
        assert not list((tmp_path / "changed").rglob("*_beh.tsv"))
        one.unlink()
        session(place, manifest, tmp_path / "away")
    finally:
        one.write_bytes(content)
