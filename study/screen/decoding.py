"""The process that decodes clips for a window, so that drawing never waits for it.

    python -m study.screen.decoding RING

It reads orders as lines of JSON from its standard input and ends with it, so that it outlives no
session. What is wrong with a clip is a line of JSON on its standard output.
"""

import json
import sys
import time
from pathlib import Path
from threading import Thread
from typing import Any

from stimuli.errors import InputError
from stimuli.render.video import wanted_frames
from stimuli.sets.masters import clip_content
from study.screen.ring import BEGUN, DONE, LANES, MADE, TURN, Lane, Ring

_NAP = 0.0005


def decode(ring: Ring, order: dict[str, Any], turn: int) -> None:
    """Fill a lane with the frames that are wanted of a clip, as far ahead as it has room."""
    lane = Lane(order["lane"], order["offset"], order["slots"], tuple(order["shape"]))
    slots, path = ring.frames(lane), Path(order["path"])
    try:
        content = clip_content(path, order["sha256"])
        pictures = wanted_frames(path, content, order["wanted"], order["whole"])
        for count, picture in enumerate(pictures):
            while count - ring.numbers[DONE + lane.number] >= lane.slots:
                if ring.numbers[TURN] != turn:
                    return
                time.sleep(_NAP)
            if ring.numbers[TURN] != turn:
                return
            slots[count % lane.slots] = picture
            ring.numbers[MADE + lane.number] = count + 1
    except InputError as error:
        print(json.dumps({"turn": turn, "error": str(error)}), flush=True)


def main(words: list[str]) -> int:
    """Take orders until there are no more."""
    ring = Ring(Path(words[0]))
    try:
        threads: list[Thread] = []
        for line in sys.stdin:
            orders = json.loads(line)
            for thread in threads:  # which see the new turn and end: two never write in one place
                thread.join()
            turn = orders["turn"]
            ring.numbers[MADE : MADE + LANES] = ring.numbers[DONE : DONE + LANES] = 0
            ring.numbers[BEGUN] = turn
            threads = [
                Thread(target=decode, args=(ring, order, turn), daemon=True)
                for order in orders["lanes"]
            ]
            for thread in threads:
                thread.start()
    finally:
        ring.path.unlink(missing_ok=True)  # whose maker may have been killed
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
