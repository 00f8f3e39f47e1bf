"""Clips as video files: masters that keep every pixel, and H.264 for looking at.

A master's frames stand alone: each is packed for itself, so that a frame that several clips share
is packed once, and any can be read by itself. QuickTime's run lengths (`.mov`) are written and read
several times as fast as FFV1 (`.mkv`), which takes a quarter of the room and checks every slice.
"""

import io
import os
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stimuli.errors import InputError
from stimuli.files import permitted, refusals_name

Pictures = NDArray[np.uint8]
RENDER_AGAIN = "Build the stimulus set again with segue render."


@dataclass(frozen=True)
class Master:
    """A way of keeping every pixel: an encoder, its pixels and options, the files' ending."""

    codec: str
    suffix: str
    pixels: str
    options: Mapping[str, str]


FAST, ARCHIVE = "qtrle", "ffv1"
MASTERS: Mapping[str, Master] = {
    FAST: Master("qtrle", ".mov", "rgb24", MappingProxyType({"g": "1"})),
    # RGB without chroma loss, a checksum in every slice.
    ARCHIVE: Master(
        "ffv1",
        ".mkv",
        "bgr0",
        MappingProxyType({"level": "3", "slices": "4", "slicecrc": "1", "g": "1"}),
    ),
}


class Packer:
    """Packs pictures of one size, each for itself, as a master's file has them."""

    def __init__(self, master: Master, width: int, height: int) -> None:
        import av

        context: Any = av.CodecContext.create(master.codec, "w")
        context.options = dict(master.options)
        context.width, context.height = width, height
        context.pix_fmt = master.pixels
        context.time_base = Fraction(1, 30)  # of which no packet knows
        context.thread_count = 1  # a worker a core already
        self._context = context

    def pack(self, picture: Pictures) -> bytes:
        """The bytes of one picture (height, width, 3)."""
        (packet,) = self._context.encode(_frame(picture))
        return bytes(packet)


def write_packed(
    path: Path, master: Master, size: tuple[int, int], packed: Iterable[bytes], fps: float
) -> int:
    """Write a master of packed pictures of `size` (width, height), whole or not at all.

    Returns how many they are. UnwritableError where the file cannot be written.
    """

    def fill(beside: Path) -> int:
        import av

        count = 0
        rate = _rate(fps)
        with av.open(str(beside), "w", container_options=_EXACT) as container:
            stream = _stream(container, master.codec, rate, master.pixels, size, master.options)
            for count, data in enumerate(packed, 1):
                packet = av.Packet(data)
                packet.stream = stream
                packet.time_base = 1 / rate
                packet.pts = packet.dts = count - 1
                packet.duration = 1
                packet.is_keyframe = True
                container.mux(packet)
        return count

    return _whole_or_not(path, fill)


def write_video(path: Path, frames: Iterable[Pictures], fps: float) -> int:
    """Write frames (height, width, 3) to `path`, whole or not at all; returns their number.

    The suffix decides: .mov and .mkv are masters, .mp4 is H.264. InputError for any other,
    UnwritableError where the file cannot be written.
    """
    suffix = path.suffix.lower()
    if suffix not in ENCODERS:
        raise InputError(
            f"{path}: expected a name that ends in {' or '.join(ENCODERS)}, found "
            f"{path.suffix or 'no ending'}."
        )
    return _whole_or_not(path, lambda beside: _encode(beside, frames, fps, ENCODERS[suffix]))


def _whole_or_not(path: Path, fill: Callable[[Path], int]) -> int:
    """A file that `fill` writes beside its place, synced and renamed; what `fill` returns."""
    with refusals_name(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(
            dir=path.parent, prefix=f".{path.stem}.", suffix=f".part{path.suffix.lower()}"
        )
        os.close(handle)
        beside = Path(name)
        try:
            count = fill(beside)
            with beside.open("r+b") as written:
                os.fsync(written.fileno())
            beside.chmod(permitted())
            beside.replace(path)
        except BaseException:
            beside.unlink(missing_ok=True)
            raise
    return count


def decode_video(path: Path, content: bytes | None = None) -> Pictures:
    """(F, height, width, 3) RGB frames of a clip; InputError for a file that is no video.

    `content` is what the file holds, where it was read already.
    """
    import av

    source: Any = str(path) if content is None else io.BytesIO(content)
    try:
        with av.open(source) as container:
            frames = _decoded(container)
    except (av.FFmpegError, IndexError) as error:
        raise InputError(
            f"{path}: expected a video clip, found a file that cannot be decoded ({error}).\n"
            f"{RENDER_AGAIN}"
        ) from error
    if not len(frames):
        raise InputError(
            f"{path}: expected a video clip, found no picture in it: it was cut short.\n"
            f"{RENDER_AGAIN}"
        )
    return frames


def _decoded(container: Any) -> Pictures:
    """All frames of a container; of as many as it says, each goes to its place at once."""
    pictures: Iterator[Pictures] = (
        frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)
    )
    stream = container.streams.video[0]
    told = stream.frames
    if not told:
        rows = list(pictures)
        return np.stack(rows) if rows else np.empty((0, 0, 0, 3), dtype=np.uint8)
    frames = np.empty((told, stream.height, stream.width, 3), dtype=np.uint8)
    count = 0
    for count, picture in zip(range(1, told + 1), pictures, strict=False):
        frames[count - 1] = picture
    return frames[:count]


def wanted_frames(
    path: Path, content: bytes, wanted: Sequence[int], whole: int
) -> Iterator[Pictures]:
    """The frames (height, width, 3) of a clip that are wanted, in ascending order, one by one.

    A master's others are never decoded. InputError where there are not `whole` frames in all, or
    the file is no video.
    """
    import av

    try:
        opened: Any = av.open(io.BytesIO(content))
        with opened as container:
            stream = container.streams.video[0]
            stream.codec_context.thread_count = 1
            packets = [packet for packet in container.demux(stream) if packet.size]
            if len(packets) != whole:
                raise InputError(
                    f"{path}: expected {whole} frames, found {len(packets)}: it was cut short.\n"
                    f"{RENDER_AGAIN}"
                )
            if all(packet.is_keyframe for packet in packets):
                for index in wanted:
                    yield stream.decode(packets[index])[0].to_ndarray(format="rgb24")
                return
            kept = set(wanted)
            decoded = (frame for packet in (*packets, None) for frame in stream.decode(packet))
            for index, frame in enumerate(decoded):
                if index in kept:
                    yield frame.to_ndarray(format="rgb24")
    except (av.FFmpegError, IndexError) as error:
        raise InputError(
            f"{path}: expected a video clip, found a file that cannot be decoded ({error}).\n"
            f"{RENDER_AGAIN}"
        ) from error


Opened = Callable[[Any, Pictures, Fraction], Any]


def _encode(path: Path, frames: Iterable[Pictures], fps: float, opened: Opened) -> int:
    import av

    count = 0
    with av.open(str(path), "w", container_options=_EXACT) as container:
        stream: Any = None
        for picture in frames:
            count += 1
            if stream is None:
                stream = opened(container, picture, _rate(fps))
            frame = _frame(picture)
            if stream.pix_fmt.startswith("yuv"):
                frame = _tagged(frame, stream.pix_fmt)
            container.mux(stream.encode(frame))
        if stream is not None:
            container.mux(stream.encode())
    return count


def _master(name: str) -> Opened:
    master = MASTERS[name]

    def opened(container: Any, picture: Pictures, rate: Fraction) -> Any:
        size = (picture.shape[1], picture.shape[0])
        return _stream(container, master.codec, rate, master.pixels, size, master.options)

    return opened


def _h264(container: Any, picture: Pictures, rate: Fraction) -> Any:
    """For looking at on any machine, visually lossless; frames in the order they are shown."""
    height, width = picture.shape[:2]
    pixels = "yuv420p" if height % 2 == width % 2 == 0 else "yuv444p"
    options = {"crf": "16", "preset": "medium", "bf": "0", "g": "15"}
    stream = _stream(container, "libx264", rate, pixels, (width, height), options)
    context = stream.codec_context
    context.color_primaries, context.color_trc = _BT709, _SRGB
    context.colorspace, context.color_range = _BT709, _LIMITED
    return stream


_EXACT = {"fflags": "+bitexact"}
_BT709, _SRGB = 1, 13  # numbers of ITU-T H.273
_LIMITED = 1  # FFmpeg's number for 16 to 235: converted to it, not merely marked
ENCODERS: Mapping[str, Opened] = {
    ".mov": _master(FAST), ".mkv": _master(ARCHIVE), ".mp4": _h264
}  # fmt: skip


def _tagged(frame: Any, pixels: str) -> Any:
    """The frame converted to the Y′CbCr of BT.709 in limited range, and marked so."""
    from av.video.reformatter import ColorRange, Colorspace

    return frame.reformat(
        format=pixels,
        src_color_range=ColorRange.JPEG,
        dst_colorspace=Colorspace.ITU709,
        dst_color_range=ColorRange.MPEG,
    )


def _frame(picture: Pictures) -> Any:
    import av

    return av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="rgb24")


def _rate(fps: float) -> Fraction:
    return Fraction(fps).limit_denominator(1001)


def _stream(
    container: Any,
    codec: str,
    rate: Fraction,
    pixels: str,
    size: tuple[int, int],
    options: Mapping[str, str],
) -> Any:
    stream = container.add_stream(codec, rate=rate, options=dict(options))
    stream.width, stream.height = size
    stream.pix_fmt = pixels
    stream.codec_context.thread_count = 1  # a worker a core already
    return stream
