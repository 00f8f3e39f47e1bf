"""Frames that clips share: drawn once, put together whole, the same whoever draws."""

import hashlib
import multiprocessing
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from stimuli.errors import InputError, InputWarning, MachineError
from stimuli.motion import Library
from stimuli.render.scene import Renderer
from stimuli.render.video import ARCHIVE, FAST, MASTERS, Packer, decode_video, write_packed
from stimuli.sets import Pairing, SetSpec, build, load_manifest
from stimuli.sets.drawing import Drawing
from stimuli.sets.frames import DrawJob, jobs_of, one_sign
from stimuli.sets.group import PlannedGroup, plan_groups
from stimuli.sets.masters import frames_hash
from stimuli.sets.video import read_clip

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def group(spec: SetSpec, library: Library) -> PlannedGroup:
    return plan_groups(spec, library)[0]


def jobs(group: PlannedGroup) -> list[tuple[str, list[bytes], DrawJob]]:
    return list(jobs_of(group.scenery, [(c.hash, c.bones, c.ground) for c in group.clips]))


def test_each_frame_is_drawn_once_and_only_blends_differ(group: PlannedGroup) -> None:
    planned = jobs(group)
    drawn = [key for _, _, job in planned for key in job.keys]
    assert len(set(drawn)) == len(drawn)
    assert {key for _, keys, _ in planned for key in keys} == set(drawn)
    frames = len(group.clips[0].bones)
    first, last = group.clips[-1].document["mixed"]  # the longest blend
    assert len(drawn) <= frames + (len(group.clips) - 1) * (last - first + 1)


def test_a_frame_drawn_once_is_what_each_clip_would_have_drawn(group: PlannedGroup) -> None:
    """Every frame of every clip drawn for itself, against the digests of the shared ones."""
    drawing = Drawing(FAST, "auto")
    digests = {
        frame.key: frame.sha256
        for _, _, job in jobs(group)
        for frame in drawing.frames(job, group.scenery)
    }
    drawing.close()
    renderer = Renderer(group.scenery.look)
    renderer.show(group.body.skin, group.camera)
    for clip, (_, keys, _) in zip(group.clips, jobs(group), strict=True):
        pictures = renderer.frames(clip.bones, clip.ground)
        alone = [hashlib.sha256(picture.data).digest() for picture in pictures]
        assert alone == [digests[key] for key in keys]
    renderer.close()


def test_a_motion_and_its_negative_are_one(group: PlannedGroup) -> None:
    bones = group.clips[0].bones
    flipped = bones * np.where(np.arange(len(bones)) % 2, -1, 1)[:, None, None].astype(np.float32)
    assert one_sign(flipped).tobytes() == one_sign(bones).tobytes()
    np.testing.assert_array_equal(np.abs(one_sign(bones)), np.abs(bones))


@pytest.mark.parametrize("codec", MASTERS)
def test_packed_frames_make_the_file_that_encoding_them_makes(codec: str, tmp_path: Path) -> None:
    from stimuli.render import write_video

    pictures = np.random.default_rng(3).integers(0, 256, (4, 49, 65, 3), dtype=np.uint8)
    master = MASTERS[codec]
    packer = Packer(master, 65, 49)
    packed, whole = (tmp_path / f"{name}{master.suffix}" for name in ("packed", "whole"))
    order = [0, 1, 1, 2, 3, 0]
    packets = [packer.pack(picture) for picture in pictures]
    assert write_packed(packed, master, (65, 49), [packets[n] for n in order], 30) == 6
    write_video(whole, pictures[order], 30)
    assert packed.read_bytes() == whole.read_bytes()
    np.testing.assert_array_equal(decode_video(packed), pictures[order])


def test_an_archive_has_the_same_pictures_and_serves_as_a_set(
    spec: SetSpec, library: Library, out: Path
) -> None:
    fast = build(spec, library, out, workers=1)
    frames = [read_clip(entry) for entry in fast.clips]
    kept = build(spec, library, out, workers=1, archive=True)
    assert kept.rendered == len(kept.clips)
    assert {entry.path.suffix for entry in kept.clips} == {MASTERS[ARCHIVE].suffix}
    assert {path.suffix for path in (out / "clips").iterdir()} == {".mkv", ".json"}
    assert [e.frames_sha256 for e in kept.clips] == [e.frames_sha256 for e in fast.clips]
    for entry, before in zip(kept.clips, frames, strict=True):
        np.testing.assert_array_equal(read_clip(entry), before)
    again = build(spec, library, out, workers=1)
    assert (again.rendered, again.hash) == (0, fast.hash)


def test_one_clip_in_the_place_of_another_is_refused(
    spec: SetSpec, library: Library, out: Path
) -> None:
    manifest = build(spec, library, out, workers=1)
    one, other = manifest.clips[0], manifest.clips[1]
    one.path.write_bytes(other.path.read_bytes())
    with pytest.raises(InputError, match=r"found another file.*\n.*segue render") as caught:
        read_clip(one)
    assert str(one.path) in str(caught.value)
    read_clip(other)


def test_sets_of_before_are_still_read(spec: SetSpec, library: Library, out: Path) -> None:
    """Half of a study may have seen one: manifests of format 1 had no hashes of files."""
    import json

    manifest = build(spec, library, out, workers=1, archive=True)
    path = out / "manifest.json"
    document = json.loads(path.read_text())
    document["format"] = 1
    for clip in document["clips"]:
        for key in ("file_sha256", "bytes", "codec", "drivers"):
            del clip[key]
    path.write_text(json.dumps(document))
    old = load_manifest(out)
    assert old.hash == manifest.hash
    digests = (hashlib.sha256(frame).digest() for frame in read_clip(old.clips[0]))
    assert frames_hash(digests) == manifest.clips[0].frames_sha256


def test_a_process_that_dies_is_named_and_the_next_build_goes_on(
    spec: SetSpec, library: Library, out: Path
) -> None:
    def kill(done: int, total: int) -> None:
        for process in multiprocessing.active_children() if done == 1 else []:
            assert process.pid is not None
            os.kill(process.pid, signal.SIGKILL)

    long = replace(spec, seconds=4.0, longer=(3, 5, 7))
    with pytest.raises(MachineError, match=r"a process died.*\n.*--workers 1"):
        build(long, library, out, workers=1, progress=kill)
    assert not (out / "manifest.json").exists()
    assert not list(out.rglob("*.part*"))
    there = len(list(out.glob("clips/*.json")))
    assert there >= 1
    assert build(long, library, out, workers=1).rendered == 6 - there


@pytest.mark.parametrize("place", ["/proc/segue", "file/set"])
def test_a_place_where_no_set_can_be_is_named(
    spec: SetSpec, library: Library, tmp_path: Path, place: str
) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="expected a place where a file can be written"):
        build(spec, library, tmp_path / place, workers=1)


def test_all_that_a_set_is_refused_for_comes_at_once(spec: SetSpec, library: Library) -> None:
    walks = [f"generated-walker-{n}" for n in range(3)]
    bad = replace(
        spec,
        reference=None, shorter=(), longer=(), methods=("fixed", "velocity"),
        pairings=(
            Pairing("late", walks[0], 9999, walks[1], 20),
            Pairing("absent", walks[0], 12, "nowhere", 20),
            *spec.pairings,
            Pairing("both", walks[0], -1, walks[1], 9999),
        ),
    )  # fmt: skip
    with pytest.raises(InputError) as caught:
        plan_groups(bad, library)
    lines = str(caught.value).splitlines()
    assert [line.split(":")[0] for line in lines] == [
        "set tiny, late", "set tiny, absent", "set tiny, both", "set tiny, both",
    ]  # fmt: skip
    assert "found 9999" in lines[0]
    assert "nowhere" in lines[1]


def test_a_motion_that_changed_is_told_and_rendered_anew(
    spec: SetSpec, library: Library, tmp_path: Path
) -> None:
    folder = tmp_path / "walkers"
    folder.mkdir()
    for path in library.directories[0].iterdir():
        (folder / path.name).write_bytes(path.read_bytes())
    before = build(spec, Library([folder]), tmp_path / "set", workers=1)
    one, other = (library.find(f"generated-walker-{n}").name for n in (1, 2))
    (folder / one).write_bytes((folder / other).read_bytes())
    with pytest.warns(InputWarning, match="generated-walker-1 changed since the set was rendered"):
        after = build(spec, Library([folder]), tmp_path / "set", workers=1)
    assert after.rendered == 4
    assert after.hash != before.hash


ONE_SAMPLE = """
import sys
import numpy as np
from stimuli.motion import walker
from stimuli.render import Appearance, group_camera
from stimuli.render.bodies import bone_motion, make_body
from stimuli.render.context import import_gl
from stimuli.render.scene import Renderer
gl = import_gl()
storage = gl.glRenderbufferStorageMultisample
gl.glRenderbufferStorageMultisample = lambda target, samples, *rest: storage(target, 0, *rest)
walk, look = walker(0), Appearance(width=320, height=240, camera="fixed")
body = make_body(walk)
drawing = Renderer(look)
drawing.show(body.skin, group_camera(body, [walk], look, 5))
np.save(sys.argv[1], np.stack(list(drawing.frames(bone_motion(body, walk)[:3]))))
print(drawing.driver)
drawing.close()
"""


def test_another_driver_differs_in_a_few_pixels_of_edges(tmp_path: Path) -> None:
    """Without multisampling, which Mesa's second software driver lacks."""
    pictures = []
    for name in ("llvmpipe", "softpipe"):
        path = tmp_path / f"{name}.npy"
        done = subprocess.run(
            [sys.executable, "-c", ONE_SAMPLE, str(path)], capture_output=True, text=True,
            env={**os.environ, "PYTHONPATH": str(ROOT), "GALLIUM_DRIVER": name,
                 "MESA_GL_VERSION_OVERRIDE": "4.1"},
        )  # fmt: skip
        if done.returncode or name not in done.stdout:
            pytest.skip(f"this machine's Mesa has no {name}")
        pictures.append(np.load(path).astype(int))
    apart = np.abs(pictures[0] - pictures[1]).max(axis=-1)
    figure = np.any(pictures[0] != pictures[0][0, 0, 0], axis=-1)
    assert figure.sum() > 5000
    assert (apart > 0).sum() < 0.005 * figure.sum()
    assert (apart > 2).sum() < 0.001 * figure.sum()


def test_a_group_drawn_by_two_drivers_is_told(spec: SetSpec, library: Library, out: Path) -> None:
    manifest = build(spec, library, out, workers=1)
    (driver,) = manifest.clips[0].document["drivers"]
    assert " bits" not in driver, "which differ from processor to processor, and draw alike"
    kept = out / "clips" / f"{manifest.clips[0].hash}.json"
    kept.write_text(kept.read_text().replace(driver, "another / OpenGL 4.1"))
    with pytest.warns(InputWarning, match=r"drawn by one driver, found those of another .* and"):
        again = build(spec, library, out, workers=1)
    assert again.rendered == 0
    assert again.clips[0].document["drivers"] == ["another / OpenGL 4.1"]


@pytest.mark.parametrize(
    ("wanted", "found"), [("7", "1 in all"), ("gpu", "such a device"), ("best", "'best'")]
)
def test_a_device_that_is_not_there_is_refused(
    spec: SetSpec, library: Library, out: Path, wanted: str, found: str
) -> None:
    if wanted == "gpu" and Path("/dev/dri").exists():
        pytest.skip("this machine may have a card")
    with pytest.raises(InputError, match=found):
        build(spec, library, out, workers=1, device=wanted)
    assert not (out / "manifest.json").exists()


def test_software_is_a_device_of_its_own(spec: SetSpec, library: Library, out: Path) -> None:
    software = build(spec, library, out, workers=1, device="software")
    assert all("pipe" in clip.document["drivers"][0] for clip in software.clips)
