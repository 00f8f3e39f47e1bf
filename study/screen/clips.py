"""Clips decoded before the trial that shows them, kept while there is room."""

from collections import OrderedDict
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from study.trials.trial import ClipKey

Frames = NDArray[np.uint8]
ROOM_BYTES = 1_500_000_000


class ClipCache:
    """Decoded clips, (F, H, W, 3) uint8 each; the longest unused leaves when room is short."""

    def __init__(self, decode: Callable[[ClipKey], Frames], room: int = ROOM_BYTES) -> None:
        self._decode = decode
        self._room = room
        self._held: OrderedDict[ClipKey, Frames] = OrderedDict()

    def frames(self, keys: Iterable[ClipKey]) -> dict[ClipKey, Frames]:
        """The frames of these clips; those that are not held are decoded now, side by side."""
        wanted = list(dict.fromkeys(keys))
        missing = [key for key in wanted if key not in self._held]
        with ThreadPoolExecutor() as pool:
            self._held.update(zip(missing, pool.map(self._decode, missing), strict=True))
        for key in wanted:
            self._held.move_to_end(key)
        while len(self._held) > len(wanted) and self._bytes() > self._room:
            self._held.popitem(last=False)
        return {key: self._held[key] for key in wanted}

    def _bytes(self) -> int:
        return sum(frames.nbytes for frames in self._held.values())
