"""A stimulus set is shown only for the protocol that it was rendered from."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from stimuli.errors import InputError
from stimuli.sets import load_manifest
from stimuli.sets.manifest import Manifest
from study.protocol.protocol import Protocol
from study.protocol.rendered import check_rendered
from study.session.lab import Request, run_session
from study.session.stage import Nowhere
from study.trials.reading import load_protocol

LENGTHS = """
name = "mine"
task = "odd-pair"
[stimuli]
reference = 10
shorter = [4]
longer = [4, 8]
motions = [{ name = "m", from = "walk", to = "run" }, { name = "n", from = "run", to = "walk" }]
[sets.first]
walk = { clip = "absent", frame = 1 }
run = { clip = "gone", frame = 2 }
[sets.second]
walk = { clip = "x", frame = 8 }
run = { clip = "y", frame = 2 }
[staircase]
rule = "wang"
stop = { trials = 2 }
[observer]
shorter = -4
longer = 4
slope = 1.0
"""
METHODS = LENGTHS.replace("odd-pair", 'preference"\nmethods = ["geodesic", "fixed"]\n#').split(
    "[staircase]"
)[0].replace("reference = 10\nshorter = [4]\nlonger = [4, 8]\n", "")  # fmt: skip


def protocol_at(tmp_path: Path, text: str) -> Protocol:
    path = tmp_path / "mine.toml"
    path.write_text(text)
    return load_protocol(path)


def manifest_of(protocol: Protocol, tmp_path: Path, **changes: Any) -> Manifest:
    """What `segue render` writes of a protocol's second set, without its clips."""
    stimuli, roles = protocol.file.stimuli, protocol.file.sets["second"].roles
    seconds = changes.pop("seconds", stimuli.seconds)
    kinds: list[tuple[str | None, int]] = (
        [(method, 9) for method in protocol.file.methods]
        if protocol.file.methods
        else [(None, n) for n in (6, 10, 14, 18)]
    )

    def source(role: str) -> dict[str, Any]:
        return {"clip": roles[role].clip, "frame": roles[role].frame}

    def clip(motion: str, method: str | None, length: int) -> Mapping[str, Any]:
        return {
            "hash": f"{motion}{method}{length}", "file": "clip.mkv", "motion": motion,
            "method": method, "length": length, "frames": 180, "frames_sha256": "f",
            "smooth": stimuli.smooth, "appearance": protocol.file.appearance.model_dump(),
        }  # fmt: skip

    document = {
        "format": 1, "name": protocol.name, "hash": "h", "fps": 30, "seconds": seconds,
        "frames": 180, "width": 640, "height": 480, "background": [0.5, 0.5, 0.5],
        "specification": stimuli.specification,
        "pairings": {
            pair.name: {
                "reference_length": stimuli.reference,
                "lengths": [] if protocol.file.methods else [n for _, n in kinds],
                "methods": {method: n for method, n in kinds if method},
                "from": source(pair.from_),
                "to": source(pair.to),
            }
            for pair in stimuli.motions
        },
        "clips": [clip(pair.name, *kind) for pair in stimuli.motions for kind in kinds],
        **changes,
    }  # fmt: skip
    folder = tmp_path / "set"
    folder.mkdir(exist_ok=True)
    (folder / "clip.mkv").touch()
    (folder / "manifest.json").write_text(json.dumps(document))
    return load_manifest(folder)


@pytest.mark.parametrize("text", [LENGTHS, METHODS])
def test_a_set_of_the_protocol_is_shown(tmp_path: Path, text: str) -> None:
    protocol = protocol_at(tmp_path, text)
    check_rendered(protocol, manifest_of(protocol, tmp_path))


@pytest.mark.parametrize(
    ("text", "change", "told"),
    [
        (LENGTHS, ('"x", frame = 8', '"x", frame = 12'), "from x:8, the protocol says x:12"),
        (LENGTHS, ('clip = "y"', 'clip = "z"'), "to y:2, the protocol says z:2"),
        (LENGTHS, ("[stimuli]", "[stimuli]\nsmooth = true"), "smooth false, .* says true"),
        (LENGTHS, ("[stimuli]", "[stimuli]\nseconds = 4"), "clips of 6 s, the protocol says 4 s"),
        (LENGTHS, ("longer = [4, 8]", "longer = [4]"), "6, 10, 14, 18, .* says 6, 10, 14$"),
        (LENGTHS, ("reference = 10", "reference = 12"), "length 10, the protocol says 12"),
        (LENGTHS, ("reference = 10", 'specification = "center-aligned"\nreference = 10'),
         "start-end, the protocol says center-aligned"),
        (LENGTHS, ("[sets.first]", "[appearance]\nwidth = 320\n[sets.first]"), "width 0, .* 320"),
        (LENGTHS, ('name = "n"', 'name = "o"'), "no motion o of the protocol"),
        (METHODS, ('"fixed"]', '"velocity"]'), "by geodesic, fixed, .* says geodesic, velocity"),
    ],
)  # fmt: skip
def test_a_set_rendered_before_the_protocol_was_edited_is_refused(
    tmp_path: Path, text: str, change: tuple[str, str], told: str
) -> None:
    manifest = manifest_of(protocol_at(tmp_path, text), tmp_path)
    protocol = protocol_at(tmp_path, text.replace(*change))
    with pytest.raises(InputError, match=told.removesuffix("$")) as caught:
        check_rendered(protocol, manifest)
    first, second = str(caught.value).splitlines()
    assert first.startswith(f"{tmp_path / 'set'}: ")
    assert f"segue render {tmp_path / 'mine.toml'} " in second
    assert f"--out {tmp_path / 'set'}" in second


def test_foot_lock_counts_where_the_manifest_has_it(tmp_path: Path) -> None:
    protocol = protocol_at(tmp_path, LENGTHS.replace("[stimuli]", "[stimuli]\nfoot_lock = false"))
    manifest = manifest_of(protocol, tmp_path)
    check_rendered(protocol, manifest)
    clips = [{**clip.document, "foot_lock": True} for clip in manifest.clips]
    with pytest.raises(InputError, match="foot_lock true, the protocol says false"):
        check_rendered(protocol, manifest_of(protocol, tmp_path, clips=clips))


def test_a_rehearsal_takes_short_clips_of_its_one_motion(tmp_path: Path) -> None:
    protocol = protocol_at(tmp_path, LENGTHS)
    whole = manifest_of(protocol, tmp_path)
    check_rendered(protocol, whole, rehearsal=True)
    short = manifest_of(protocol, tmp_path, seconds=1.0, pairings={"m": whole.pairings["m"]})
    check_rendered(protocol, short, rehearsal=True)
    with pytest.raises(InputError, match="no motion n"):
        check_rendered(protocol, short)


def session(protocol: Protocol, manifest: Manifest, data: Path) -> None:
    request = Request("p1", data, observer="simulated", seed=1)
    run_session(request, protocol, manifest, lambda _: True, lambda *_: Nowhere(6.0, 0.5))


def test_a_set_of_another_protocol_is_named(tmp_path: Path) -> None:
    manifest = manifest_of(protocol_at(tmp_path, LENGTHS), tmp_path, name="other", pairings={})
    protocol = protocol_at(tmp_path, LENGTHS)
    with pytest.raises(InputError, match="stimulus set of mine, found that of other") as caught:
        session(protocol, manifest, tmp_path / "data")
    assert f"`segue render {tmp_path / 'mine.toml'}`" in str(caught.value)
    assert not list((tmp_path / "data").rglob("*_beh.tsv"))


def test_a_missing_clip_names_the_protocols_path(tmp_path: Path) -> None:
    protocol = protocol_at(tmp_path, LENGTHS)
    manifest = manifest_of(protocol, tmp_path)
    (tmp_path / "set" / "clip.mkv").unlink()
    with pytest.raises(InputError, match="found none for m 10") as caught:
        session(protocol, manifest, tmp_path / "data")
    assert f"segue render {tmp_path / 'mine.toml'} --out" in str(caught.value)


def test_a_session_with_its_own_set_runs(tmp_path: Path) -> None:
    protocol = protocol_at(tmp_path, LENGTHS)
    session(protocol, manifest_of(protocol, tmp_path), tmp_path / "data")
    assert list((tmp_path / "data").rglob("*_beh.tsv"))
