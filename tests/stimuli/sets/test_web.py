"""Clips for browsers: every frame in its place, and grey the grey that it was."""

import base64
from pathlib import Path

import numpy as np

from stimuli.render import write_video
from tests.browser import ask

FRAMES, FPS, BITS = 40, 30, 6
GREYS = (0, 64, 128, 200, 255)
SCRIPT = """
const video = document.querySelector("video");
video.muted = true;
await new Promise((done, fail) => {
  if (video.readyState >= 2) done();
  video.onloadeddata = done; video.onerror = () => fail(video.error.message);
});
const canvas = document.createElement("canvas");
canvas.width = video.videoWidth; canvas.height = video.videoHeight;
const pen = canvas.getContext("2d", { willReadFrequently: true });
const seen = [];
for (const k of %s) {
  const there = new Promise((done) => { video.onseeked = done; });
  const shown = new Promise((done) => {
    const look = (now, frame) => Math.round(frame.mediaTime * %d) === k ? done() : wait();
    const wait = () => video.requestVideoFrameCallback(look);
    wait();
  });
  video.currentTime = (k + 0.5) / %d;
  await there;
  if (k > 0) await shown;  // on a busy machine the frame comes after the event
  pen.drawImage(video, 0, 0);
  seen.push([...Array(%d).keys()].map((n) => [...pen.getImageData(8 + 16 * n, 8, 1, 1).data]));
}
return { seconds: video.duration, size: [canvas.width, canvas.height], seen };
"""


def coded(frame: int) -> np.ndarray:
    """A picture that says its number in black and white, after patches of grey."""
    picture = np.full((48, 16 * (BITS + len(GREYS)), 3), 128, np.uint8)
    bits = [255 * (frame >> bit & 1) for bit in range(BITS)]
    for place, value in enumerate([*bits, *GREYS]):
        picture[:16, 16 * place : 16 * place + 16] = value
    return picture


def test_chromium_shows_the_frame_that_was_drawn_and_the_grey(tmp_path: Path) -> None:
    path = tmp_path / "clip.mp4"
    write_video(path, [coded(frame) for frame in range(FRAMES)], FPS)
    page = tmp_path / "page.html"
    content = base64.b64encode(path.read_bytes()).decode()
    page.write_text(f'<!DOCTYPE html><video src="data:video/mp4;base64,{content}"></video>')
    order = [0, 1, 2, 17, 16, 39, 15, 14, 30, 31, 3]  # forwards, backwards and far
    found = ask(page, SCRIPT % (order, FPS, FPS, BITS + len(GREYS)), tmp_path / "profile")
    assert found["size"] == [16 * (BITS + len(GREYS)), 48]
    assert abs(found["seconds"] - FRAMES / FPS) < 0.5 / FPS
    shown = np.array(found["seen"])[..., :3]
    numbers = ((shown[:, :BITS, 1] > 127) << np.arange(BITS)).sum(axis=1)
    assert numbers.tolist() == order
    assert np.abs(shown[:, BITS:] - np.array(GREYS)[:, None]).max() <= 1
