"""Decoded clips are kept while there is room, and no longer."""

import numpy as np

from study.screen.clips import ClipCache
from study.trials.trial import ClipKey


def test_a_clip_is_decoded_once_until_room_is_short() -> None:
    decoded = []

    def decode(key: ClipKey) -> np.ndarray:
        decoded.append(key.motion)
        return np.zeros((1, 10, 10, 3), np.uint8)

    clips = ClipCache(decode, room=900)
    a, b, c, d = (ClipKey(name) for name in "abcd")
    found = clips.frames([a, b, a])
    assert found[a].shape == (1, 10, 10, 3)
    assert sorted(decoded) == ["a", "b"]
    clips.frames([c])
    clips.frames([a])
    clips.frames([d])
    assert decoded[2:] == ["c", "d"]
    clips.frames([a])
    assert len(decoded) == 4
    clips.frames([b])
    assert decoded[4:] == ["b"]
    assert set(clips.frames([a, b, c, d])) == {a, b, c, d}
