"""Sets rendered for real, very small: once, whole, and the same every time."""

import hashlib
import json
import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from filelock import FileLock

from stimuli.errors import InputError, MachineError
from stimuli.motion import Library, forward
from stimuli.sets import (
    Manifest,
    SetSpec,
    build,
    inventory,
    load_manifest,
    prune,
    stale_clips,
)
from stimuli.sets.group import plan_group
from stimuli.sets.masters import frames_hash
from stimuli.sets.plan import resolve
from stimuli.sets.video import decode_video, read_clip

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(scope="module")
def module_out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("module") / "set"


def pixels(manifest: Manifest) -> list[str]:
    return [entry.frames_sha256 for entry in manifest.clips]


def test_a_set_is_built_once_and_read_back(
    spec: SetSpec, library: Library, module_out: Path
) -> None:
    told: list[tuple[int, int]] = []
    first = build(
        spec, library, module_out, progress=lambda done, total: told.append((done, total))
    )
    assert first.rendered == 4
    assert told == [(done, 4) for done in range(5)]
    times = {path: path.stat().st_mtime_ns for path in module_out.rglob("*.*")}
    second = build(spec, library, module_out)
    assert second.rendered == 0
    assert {path: path.stat().st_mtime_ns for path in module_out.rglob("*.*")} == times
    read = load_manifest(module_out)
    assert read.hash == first.hash == second.hash
    assert [entry.length for entry in read.clips] == [2, 4, 6, 9]
    assert read.pairings["walk"]["reference_length"] == 6
    assert read.size == (96, 72)
    assert read.frames == 15
    for entry in read.clips:
        frames = read_clip(entry)
        assert frames.shape == (15, 72, 96, 3)
        assert (
            frames_hash(hashlib.sha256(frame).digest() for frame in frames) == entry.frames_sha256
        )
        assert entry.document["mixed"][0] <= 7 <= entry.document["mixed"][1]
    assert read.clip("walk", length=9).length == 9
    with pytest.raises(InputError, match="length 5"):
        read.clip("walk", length=5)


def test_one_worker_renders_what_two_do(
    spec: SetSpec, library: Library, module_out: Path, out: Path
) -> None:
    """To the byte, on one machine."""
    one, two = build(spec, library, out, workers=1), load_manifest(module_out)
    assert one.hash == two.hash
    assert pixels(one) == pixels(two)


def test_before_the_blend_pictures_are_the_same_and_at_it_they_differ(
    spec: SetSpec, library: Library, module_out: Path
) -> None:
    manifest = load_manifest(module_out)
    short, long = (decode_video(manifest.clip("walk", length=length).path) for length in (2, 9))
    first = min(entry.document["first_altered"] for entry in manifest.clips)
    assert 0 < first < 7
    np.testing.assert_array_equal(short[:first], long[:first])
    assert np.any(short[first:] != long[first:])


def test_every_joint_is_in_frame_in_every_clip(spec: SetSpec, library: Library) -> None:
    group = plan_group(spec, resolve(spec, library)[0], library)
    for clip in group.clips:
        motion = clip.laid_out.motion
        positions, _ = forward(motion.skeleton, motion.rotations, motion.root)
        pixels, _ = group.camera.project(positions, 96, 72)
        assert np.all((pixels >= 0) & (pixels <= [96, 72]))


def test_a_change_renders_anew_and_the_old_clips_stay_until_pruned(
    spec: SetSpec, library: Library, module_out: Path
) -> None:
    brighter = replace(spec, appearance=replace(spec.appearance, background=(0.6, 0.6, 0.6)))
    assert len(inventory(brighter, library, module_out).missing) == 4
    manifest = build(brighter, library, module_out, workers=1)
    assert manifest.rendered == 4
    assert len(stale_clips(manifest)) == 4
    back = build(spec, library, module_out)
    assert back.rendered == 0
    assert prune(back) == 4
    assert stale_clips(back) == ()
    assert build(spec, library, module_out).rendered == 0


def test_damage_is_repaired_and_leftovers_are_cleared(
    spec: SetSpec, library: Library, module_out: Path
) -> None:
    before = load_manifest(module_out)
    short, long = before.clips[0].path, before.clips[1].path
    short.write_bytes(short.read_bytes()[:100])
    long.with_suffix(".json").unlink()
    leftover = module_out / "clips" / ".deadbeef.abc.part.mov"
    leftover.write_bytes(b"half")
    after = build(spec, library, module_out, workers=1)
    assert after.rendered == 2
    assert pixels(after) == pixels(before)
    assert not leftover.exists()


def test_a_second_build_of_the_same_set_waits_its_turn(
    spec: SetSpec, library: Library, module_out: Path
) -> None:
    with FileLock(module_out / ".lock"), pytest.raises(InputError, match="going on"):
        build(spec, library, module_out)


BUILD = """
import sys
from pathlib import Path
from stimuli.sets import Appearance, Pairing, SetSpec, build
from stimuli.motion import Library
pairing = Pairing("walk", "generated-walker-0", 12, "generated-walker-1", 20)
spec = SetSpec("tiny", (pairing,), "center-aligned", reference=6, shorter=tuple(range(1, 6)),
               longer=tuple(range(1, 7)), seconds=0.5,
               appearance=Appearance(width=96, height=72, camera="fixed",
                                     style="mannequin"))
if __name__ == "__main__":
    print(build(spec, Library([Path(sys.argv[1])]), Path(sys.argv[2]), workers=1).rendered)
"""


def test_a_killed_build_goes_on_where_it_stopped(library: Library, out: Path) -> None:
    script = out.parent / "build_tiny.py"
    script.write_text(BUILD)
    command = [sys.executable, str(script), str(library.directories[0]), str(out)]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    process = subprocess.Popen(command, env=environment)
    patience = time.monotonic() + 60
    while not list(out.glob("clips/*.json")) and time.monotonic() < patience:
        time.sleep(0.02)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert not (out / "manifest.json").exists()
    there = {path.stem for path in out.glob("clips/*.json")}
    assert 0 < len(there) < 12
    done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    assert int(done.stdout) <= 12 - len(there)
    manifest = load_manifest(out)
    assert len(manifest.clips) == 12
    assert not list(out.glob("clips/.*.part*"))
    for entry in manifest.clips[::4]:
        digests = (hashlib.sha256(frame).digest() for frame in read_clip(entry))
        assert frames_hash(digests) == entry.frames_sha256


def test_identical_clips_are_rendered_once(spec: SetSpec, library: Library, out: Path) -> None:
    twins = replace(spec, reference=None, methods=("fixed", "geodesic"), shorter=(), longer=())
    lengths = resolve(twins, library)[0].methods
    manifest = build(twins, library, out, workers=1)
    assert len(manifest.clips) == 2
    assert manifest.rendered == len(set(lengths.values()))
    assert manifest.clip("walk", method="fixed").length == 10


def test_a_failing_worker_is_told_and_leaves_no_manifest(
    spec: SetSpec, library: Library, out: Path
) -> None:
    (out / "clips").mkdir(parents=True)
    group = plan_group(spec, resolve(spec, library)[0], library)
    blocked = out / "clips" / f"{group.clips[0].hash}.mov"
    blocked.mkdir()
    with pytest.raises(MachineError, match=f"{blocked.name}: expected a place for a clip"):
        build(spec, library, out, workers=1)
    assert not (out / "manifest.json").exists()
    assert not list(out.rglob("*.part*"))


def test_damaged_or_absent_manifests_are_refused(out: Path) -> None:
    with pytest.raises(InputError, match="segue render"):
        load_manifest(out)
    out.mkdir()
    path = out / "manifest.json"
    for text, what in (
        ("{", "damaged"),
        ("[]", "format"),
        ('{"format": 3}', "format"),
        ('{"format": 1}', "key"),
    ):
        path.write_text(text)
        with pytest.raises(InputError, match=what):
            load_manifest(out)


def test_the_manifest_says_what_each_clip_is_made_of(
    spec: SetSpec, library: Library, module_out: Path
) -> None:
    document = json.loads((module_out / "manifest.json").read_text())
    pairing = document["pairings"]["walk"]
    assert pairing["from"]["sha256"] == library.load("generated-walker-0").sha256
    assert pairing["from"]["frame"] == 12
    assert set(pairing["camera"]) >= {"position", "yaw", "elevation", "field_of_view"}
    clip = document["clips"][0]
    assert clip["file"] == f"clips/{clip['hash']}.mov"
    assert clip["specification"] == "center-aligned"
    assert clip["appearance"]["style"] == "mannequin"
    assert document["format"] == 2
    shifts = {c["length"]: c["measures"]["displacement_from_reference"] for c in document["clips"]}
    assert shifts[6] == 0
    assert shifts[4] > 0
    assert all(c["measures"]["geodesic_cost"] > 0 for c in document["clips"])


def test_every_key_of_a_manifest_is_documented(
    spec: SetSpec, library: Library, module_out: Path
) -> None:
    text = (ROOT / "stimuli/sets/MANIFEST.md").read_text(encoding="utf-8")
    told = set(re.findall(r"`(\w+)`", text))
    document = json.loads((module_out / "manifest.json").read_text())
    pairing, clip = document["pairings"]["walk"], document["clips"][0]
    parts = (document, pairing, pairing["from"], pairing["camera"], pairing["body"], clip)
    keys = {key for part in (*parts, clip["measures"]) for key in part}
    assert keys - told == set()
    assert f"Format\n{document['format']};" in text
