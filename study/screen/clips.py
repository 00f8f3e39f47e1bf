"""Clips decoded before the trial that shows them, kept while there is room."""

from collections import OrderedDict
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from study.trial import ClipKey

Frames = NDArray[np.uint8]
ROOM_BYTES = 1_500_000_000


class ClipCache:
    """Decoded clips, (F, H, W, 3) uint8 each; the longest unused leaves when room is short."""

    def __init__(self, decode: Callable[[ClipKey], Frames], room: int = ROOM_BYTES) -> None:
        self._decode = decode
        self._room = room
        self._held: OrderedDict[ClipKey, Frames] = OrderedDict()

    def __getitem__(self, key: ClipKey) -> Frames:
        """The frames of a clip, decoded now unless they are held."""
        if key not in self._held:
            self._held[key] = self._decode(key)
            self._shrink()
        self._held.move_to_end(key)
        return self._held[key]

    def _shrink(self) -> None:
        while len(self._held) > 2 and sum(f.nbytes for f in self._held.values()) > self._room:
            self._held.popitem(last=False)
