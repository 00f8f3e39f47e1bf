"""Clips as a window shows them: frames by index, decoded elsewhere while they are shown."""

import json
import queue
import subprocess
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from threading import Thread
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from stimuli.errors import InputError, MachineError
from stimuli.interpreter import own_environment, own_python
from study.screen.ring import BEGUN, DONE, LANES, MADE, TURN, Lane, Ring, lanes_for
from study.trials.trial import ClipKey

Frames = NDArray[np.uint8]
_BEFORE_SHOWN = 10  # frames of each clip that are decoded before the first is shown
_NAP = 0.0002
_PATIENCE = 20.0  # seconds for a frame before the decoder is given up


class ClipFile(NamedTuple):
    """Where a clip lies: its file and hash, how many frames that has, the first that is shown
    and how many are, and their size."""

    path: Path
    sha256: str | None
    whole: int
    first: int
    shown: int
    width: int
    height: int


class Showable(Protocol):
    """A clip while it is shown: `frame(k)` is (height, width, 3), k never falling."""

    count: int
    size: tuple[int, int]

    def ready(self) -> None:
        """Wait until it can begin."""

    def frame(self, k: int) -> Frames:
        """The k-th of the clip's frames."""


class ClipSource(Protocol):
    """Where a window gets clips from."""

    def start(self, keys: Iterable[ClipKey], wanted: Sequence[int]) -> Mapping[ClipKey, Showable]:
        """Begin to decode the wanted frames of the clips of a screen."""

    def count(self, key: ClipKey) -> int:
        """How many frames of a clip are shown."""

    def close(self) -> None:
        """Give up what decoding took."""


class Decoder:
    """Clips decoded by a process of their own into a ring of frames."""

    def __init__(self, files: Callable[[ClipKey], ClipFile]) -> None:
        self._files = files
        self._ring = Ring()
        self._turn = 0
        self._told: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()
        self._process = subprocess.Popen(
            own_python("-m", "study.screen.decoding", str(self._ring.path)), env=own_environment(),
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        )  # fmt: skip
        self._listener = Thread(target=self._listen, daemon=True)
        self._listener.start()

    def _listen(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._told.put(json.loads(line))

    def count(self, key: ClipKey) -> int:
        """How many frames of a clip are shown."""
        return self._files(key).shown

    def start(self, keys: Iterable[ClipKey], wanted: Sequence[int]) -> Mapping[ClipKey, "Decoded"]:
        """Begin to decode the wanted frames of these clips; those of an earlier start end."""
        files = {key: self._files(key) for key in dict.fromkeys(keys)}
        if len(files) > LANES:
            raise InputError(f"expected at most {LANES} clips on a screen, found {len(files)}")
        self._turn += 1
        self._ring.numbers[TURN] = self._turn
        lanes = lanes_for([(f.height, f.width, 3) for f in files.values()], len(wanted))
        orders = [
            {
                "lane": lane.number, "offset": lane.offset, "slots": lane.slots,
                "shape": lane.shape, "path": str(file.path), "sha256": file.sha256,
                "whole": file.whole, "wanted": [file.first + k for k in wanted],
            }
            for lane, file in zip(lanes, files.values(), strict=True)
        ]  # fmt: skip
        self._send({"turn": self._turn, "lanes": orders})
        return {
            key: Decoded(self, lane, file, wanted)
            for (key, file), lane in zip(files.items(), lanes, strict=True)
        }

    def _send(self, order: dict[str, Any]) -> None:
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(json.dumps(order) + "\n")
            self._process.stdin.flush()
        except OSError as error:
            raise self.died() from error

    def made(self, lane: Lane, turn: int) -> int:
        """How many frames of a lane are decoded; InputError where its clip is at fault."""
        self.check(turn)
        numbers = self._ring.numbers
        return int(numbers[MADE + lane.number]) if numbers[BEGUN] == turn else 0

    def check(self, turn: int) -> None:
        """Raise what the decoder said of the clips that are shown, or that it died."""
        while not self._told.empty():
            told = self._told.get()
            if told.get("turn") == turn:
                raise InputError(told["error"])
        if self._process.poll() is not None:
            raise self.died()

    def died(self) -> MachineError:
        """What is said when the decoder is gone."""
        return MachineError(
            "the process that decodes clips ended; all answers so far are kept: start the session "
            "again with --resume"
        )

    @property
    def ring(self) -> Ring:
        """The memory shared with the process."""
        return self._ring

    @property
    def turn(self) -> int:
        """The number of the last start."""
        return self._turn

    def close(self) -> None:
        """End the process."""
        self._ring.close()
        if self._process.stdin is not None:
            with suppress(OSError):  # of a process that died
                self._process.stdin.close()
        try:
            self._process.wait(timeout=5)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._listener.join()
        if self._process.stdout is not None:
            self._process.stdout.close()


class Decoded:
    """A clip while its frames come; see `Showable`."""

    def __init__(self, decoder: Decoder, lane: Lane, file: ClipFile, wanted: Sequence[int]) -> None:
        self._decoder, self._lane, self._turn = decoder, lane, decoder.turn
        self._places = {frame: place for place, frame in enumerate(wanted)}
        self._frames = decoder.ring.frames(lane)
        self._done = decoder.ring.numbers[DONE + lane.number :]
        self.count, self.size = file.shown, (file.width, file.height)

    def ready(self) -> None:
        """Wait until the first frames are decoded."""
        self._await(min(_BEFORE_SHOWN, len(self._places), self._lane.slots))

    def frame(self, k: int) -> Frames:
        """The k-th of the clip's frames; waits where it is not decoded yet."""
        place = self._places[k]
        self._await(1)
        self._done[0] = place  # what came before may be written over
        self._await(place + 1)
        return self._frames[place % self._lane.slots]

    def _await(self, frames: int) -> None:
        until = time.perf_counter() + _PATIENCE
        while self._decoder.made(self._lane, self._turn) < frames:
            if time.perf_counter() > until:
                raise self._decoder.died()
            time.sleep(_NAP)


class Held:
    """Clips that lie in memory whole, (F, height, width, 3) by key: for checks of a window."""

    def __init__(self, clips: Mapping[ClipKey, Frames]) -> None:
        self._clips = clips

    def count(self, key: ClipKey) -> int:
        """How many frames a clip has."""
        return len(self._clips[key])

    def start(
        self, keys: Iterable[ClipKey], wanted: Sequence[int]
    ) -> Mapping[ClipKey, "WholeClip"]:
        """The clips as they are."""
        return {key: WholeClip(self._clips[key]) for key in keys}

    def close(self) -> None:
        """Nothing to give up."""


class WholeClip:
    """A clip in memory; see `Showable`."""

    def __init__(self, frames: Frames) -> None:
        self._frames = frames
        self.count, self.size = len(frames), (frames.shape[2], frames.shape[1])

    def ready(self) -> None:
        """It is."""

    def frame(self, k: int) -> Frames:
        """The k-th frame."""
        return self._frames[k]
