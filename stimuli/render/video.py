"""Clips as video files: FFV1 in Matroska, which keeps every pixel, and H.264 for looking at."""

import os
import tempfile
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stimuli.errors import InputError
from stimuli.files import permitted, refusals_name

Pictures = NDArray[np.uint8]


def write_video(path: Path, frames: Iterable[Pictures], fps: float) -> int:
    """Write frames (height, width, 3) to `path`, whole or not at all; returns their number.

    The suffix decides: .mkv is lossless FFV1, .mp4 is H.264. InputError for any other,
    UnwritableError where the file cannot be written.
    """
    if path.suffix.lower() not in ENCODERS:
        raise InputError(
            f"{path}: expected a name that ends in {' or '.join(ENCODERS)}, found "
            f"{path.suffix or 'no ending'}."
        )
    with refusals_name(path):
        return _written(path, frames, fps)


def _written(path: Path, frames: Iterable[Pictures], fps: float) -> int:
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(
        dir=path.parent, prefix=f".{path.stem}.", suffix=f".part{path.suffix.lower()}"
    )
    os.close(handle)
    beside = Path(name)
    try:
        count = _encode(beside, frames, fps)
        with beside.open("r+b") as written:
            os.fsync(written.fileno())
        beside.chmod(permitted())
        beside.replace(path)
    except BaseException:
        beside.unlink(missing_ok=True)
        raise
    return count


def decode_video(path: Path) -> Pictures:
    """(F, height, width, 3) RGB frames of a clip; InputError for a file that is no video."""
    import av

    try:
        with av.open(str(path)) as container:
            frames = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
    except (av.FFmpegError, IndexError) as error:
        raise InputError(
            f"{path}: expected a video clip, found a file that cannot be decoded ({error}).\n"
            "Build the stimulus set again with segue render."
        ) from error
    if not frames:
        raise InputError(
            f"{path}: expected a video clip, found no picture in it: it was cut short.\n"
            "Build the stimulus set again with segue render."
        )
    return np.stack(frames)


def _encode(path: Path, frames: Iterable[Pictures], fps: float) -> int:
    import av

    count = 0
    with av.open(str(path), "w", container_options={"fflags": "+bitexact"}) as container:
        stream: Any = None
        for picture in frames:
            if stream is None:
                rate = Fraction(fps).limit_denominator(1001)
                stream = ENCODERS[path.suffix](container, picture, rate)
            frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
            container.mux(stream.encode(frame))
            count += 1
        if stream is not None:
            container.mux(stream.encode())
    return count


def _ffv1(container: Any, picture: Pictures, rate: Fraction) -> Any:
    """Lossless: RGB without chroma loss, a checksum in every slice, every frame on its own."""
    stream = container.add_stream(
        "ffv1", rate=rate, options={"level": "3", "slices": "4", "slicecrc": "1", "g": "1"}
    )
    return _sized(stream, picture, "bgr0")


def _h264(container: Any, picture: Pictures, rate: Fraction) -> Any:
    """For looking at on any machine, visually lossless."""
    stream = container.add_stream("libx264", rate=rate, options={"crf": "16", "preset": "medium"})
    halves = picture.shape[0] % 2 == picture.shape[1] % 2 == 0
    return _sized(stream, picture, "yuv420p" if halves else "yuv444p")


def _sized(stream: Any, picture: Pictures, pixels: str) -> Any:
    stream.height, stream.width = picture.shape[:2]
    stream.pix_fmt = pixels
    stream.codec_context.thread_count = 1  # a worker a core already
    return stream


ENCODERS: Mapping[str, Callable[[Any, Pictures, Fraction], Any]] = {".mkv": _ffv1, ".mp4": _h264}
