"""The sheet of a set, in a real browser: what plays is what was drawn, in step, to the frame."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from stimuli.errors import InputError
from stimuli.motion import Library, write_walker
from stimuli.sets import Appearance, Manifest, Pairing, SetSpec, build
from stimuli.sets.video import read_clip
from stimuli.sheet import gather, write_page, write_strips
from tests.browser import ask

SCRIPT = """
const press = (key) => document.dispatchEvent(new KeyboardEvent("keydown", { key }));
const until = async (holds) => { while (!holds()) await new Promise((f) => setTimeout(f, 5)); };
const all = (n) => [...document.querySelectorAll(`section[data-motion="${n}"] canvas.picture`)];
const at = (n, frame) => until(() => all(n).every((canvas) => canvas.dataset.frame == frame));
const read = (canvas) => [...canvas.getContext("2d")
  .getImageData(0, 0, canvas.width, canvas.height).data].filter((_, k) => k % 4 === 1);
const seen = {};
const mixing = () => [...document.querySelectorAll("section.chosen figure")]
  .map((figure) => figure.classList.contains("mixing"));
await until(() => all(0).every((canvas) => canvas.dataset.frame !== undefined));
const first = Number(all(0)[0].dataset.frame);
seen[first] = { pixels: all(0).map(read), mixing: mixing() };
for (let k = 1; k <= 4; k++) {
  press("ArrowRight"); await at(0, first + k);
  seen[first + k] = { pixels: all(0).map(read), mixing: mixing() };
}
press("ArrowLeft"); await at(0, first + 3);
press("ArrowDown"); await at(1, first + 3);
const chosen = document.querySelector("section.chosen h2").textContent;
press(" "); await until(() => all(1)[0].dataset.frame != first + 3);
const together = new Set();
for (let k = 0; k < 20; k++) {
  together.add(new Set(all(1).map((canvas) => canvas.dataset.frame)).size);
  await new Promise(requestAnimationFrame);
}
press(" ");
return { first, seen, chosen, together: [...together],
  state: document.getElementById("play").textContent,
  remote: performance.getEntriesByType("resource").map((entry) => entry.name)
    .filter((name) => !name.startsWith("data:")),
  overflow: document.documentElement.scrollWidth - innerWidth,
  captions: [...document.querySelectorAll("figcaption span:first-child")]
    .map((e) => e.textContent),
  warnings: [...document.querySelectorAll(".warning")].map((e) => e.textContent) };
"""


@pytest.fixture(scope="module")
def manifest(tmp_path_factory: pytest.TempPathFactory) -> Manifest:
    """Two motions by two methods, half a second long, in small pictures."""
    folder = tmp_path_factory.mktemp("sheet")
    for seed in range(2):
        write_walker(folder / "walkers", seed)
    one = Pairing("<there>", "generated-walker-0", 12, "generated-walker-1", 20, "locomotion")
    spec = SetSpec(
        "tiny", (one, replace(one, name="back", from_frame=30)), methods=("fixed", "velocity"),
        seconds=0.5, foot_lock=False,
        appearance=Appearance(width=120, height=90, style="mannequin"),
    )  # fmt: skip
    return build(spec, Library([folder / "walkers"]), folder / "set", workers=1)


@pytest.fixture(scope="module")
def page(manifest: Manifest) -> Path:
    path = manifest.directory / "sheet.html"
    write_page(manifest, list(gather(manifest, 1)), path)
    return path


@pytest.mark.parametrize("size", [(1280, 900), (500, 900)])
def test_clips_play_in_step_and_frame_by_frame(
    manifest: Manifest, page: Path, tmp_path: Path, size: tuple[int, int]
) -> None:
    found: dict[str, Any] = ask(page, SCRIPT, tmp_path / "profile", size)
    assert found["remote"] == []
    assert found["overflow"] <= 0
    assert found["chosen"] == "back"
    assert found["together"] == [1]
    assert found["state"] == "play"
    clips = [entry for entry in manifest.clips if entry.motion == "<there>"]
    masters = [read_clip(entry).astype(int) for entry in clips]
    assert len(found["seen"]) == 5
    for frame, shown in ((int(key), value) for key, value in found["seen"].items()):
        for entry, master, pixels, mixing in zip(
            clips, masters, shown["pixels"], shown["mixing"], strict=True
        ):
            seen = np.array(pixels).reshape(master.shape[1:3])
            apart = [np.abs(seen - other[..., 1]).mean() for other in master]
            assert int(np.argmin(apart)) == frame
            assert apart[frame] < 1.0
            first, last = entry.document["mixed"]
            assert mixing == (first <= frame <= last)
    assert [text.split(",")[0] for text in found["captions"]] == ["fixed", "velocity"] * 2
    told = [w for entry in manifest.clips for w in entry.document["warnings"]]
    assert len(found["warnings"]) == len(told)


def test_a_picture_is_in_the_page_once_however_many_clips_show_it(manifest: Manifest) -> None:
    for shown in gather(manifest, 1):
        fixed, velocity = (set(frames) for frames in shown.frames)
        assert fixed & velocity, "before the blend both show the same"
        assert len(shown.images) == len(fixed | velocity) < sum(map(len, shown.frames))


def test_strips_are_one_picture_with_a_row_for_each_clip(manifest: Manifest) -> None:
    path = manifest.directory / "sheet.png"
    write_strips(manifest, list(gather(manifest, 1)), path)
    with Image.open(path) as image:
        pixels = np.asarray(image.convert("RGB"))
    grey = np.all(pixels == pixels.dtype.type(128), axis=-1).mean(axis=1) > 0.3
    assert int((np.diff(grey.astype(int)) == 1).sum()) == len(manifest.clips)
    orange = np.all(pixels == [196, 78, 32], axis=-1)
    assert orange.any()


def test_a_clip_that_was_exchanged_is_in_no_sheet(manifest: Manifest) -> None:
    one, other = manifest.clips[0].path, manifest.clips[1].path
    kept = one.read_bytes()
    try:
        one.write_bytes(other.read_bytes())
        with pytest.raises(InputError, match="found another file"):
            list(gather(manifest, 1))
    finally:
        one.write_bytes(kept)
